// SPDX-License-Identifier: Apache-2.0
// Everything that happened in a run, as one JSON file that replays to the same answer.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "../calibration/calibration.hpp"
#include "../focus/focus.hpp"
#include "rig.hpp"

namespace fathom {

/// What a run was made with.
struct RunSetup {
  std::string verb;     ///< "sweep", "focus", "calibrate" or "range".
  std::string command;  ///< The command line, to run it again.
  std::string created;  ///< ISO 8601, UTC.
  std::string rig;      ///< The rig text.
  std::string camera;   ///< Its description.
  LensInfo lens;
  MetricSpec metric;
  Window window;
  std::string backend;         ///< Name, e.g. "reference".
  std::string backend_reason;  ///< What was chosen and why.
  int average = 1;
};

/// One sweep or one search.
struct Run {
  std::optional<double> target_mm;    ///< Known distance of the target, if any.
  std::optional<FocusLimits> limits;  ///< Absent for a sweep, which only evaluates.
  double repeat_scatter = 0;
  bool tracks = false;  ///< Began where the run before it ended (focus/track.hpp).
  std::vector<Measurement> measurements;  ///< In the order in which they were made.
  std::optional<Focus> focus;  ///< The answer; absent for a sweep or an unfinished search.

  std::vector<Evaluation> evaluations() const;
};

struct RunFile {
  RunSetup setup;
  std::vector<Run> runs;
  std::optional<Calibration> calibration;  ///< Fitted by calibrate, used by range.
  bool extrapolate = false;
  std::optional<Distance> distance;  ///< The answer of range.
  std::string error;  ///< Why it ended early, or empty; the measurements up to there are kept.

  /// Format "fathom-record", version 2.
  std::string json() const;
  /// Throws Error(bad_data), naming the file, for anything that json() does not write.
  static RunFile parse(std::string_view json, std::string_view name);
};

/// Runs every search, fit and conversion again from the recorded scores alone and returns the
/// record with its answers computed anew. Throws Error(bad_data) where a search asks for a position
/// that was not measured next, or the record holds what no run can have: it or the program has
/// changed. `name` stands in the message.
RunFile replay(const RunFile& record, std::string_view name);

/// Whether two records came to the same answer: results, positions, scores, fit, distance.
bool same_answer(const RunFile& a, const RunFile& b);

}  // namespace fathom
