// SPDX-License-Identifier: Apache-2.0
// Everything that happened in a measurement, as one JSON file from which it can be computed again.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "../calibration/calibration.hpp"
#include "kept_surface.hpp"
#include "rig.hpp"
#include "run.hpp"

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

/// Runs as they are kept, with what they were made on: enough to look for the focus again.
struct RunFile {
  /// Version 2, which was called a record, kept neither floors nor the traces of searches; version 3
  /// nothing of the pictures but their scores.
  static constexpr int kVersion = 4;

  RunSetup setup;
  std::vector<Run> runs;
  std::optional<Calibration> calibration;  ///< Fitted by calibrate, used by range.
  bool extrapolate = false;
  std::optional<Distance> distance;                  ///< The answer of range.
  std::optional<std::vector<KeptSurface>> surfaces;  ///< That of range --all, as it was listed.
  std::string error;       ///< Why it ended early, or empty; the measurements are kept.
  int version = kVersion;  ///< Of the file that it was read from.
  /// Whether the file that it was read from holds what was written into it, by its digest. Without
  /// one nothing is known.
  std::optional<bool> is_as_written;

  /// Format "fathom-run", version 4.
  std::string json() const;
  /// Reads that, version 3, and version 2 of "fathom-record". Throws Error(bad_data), naming the file, for
  /// anything that json() does not write.
  static RunFile parse(std::string_view json, std::string_view name);
};

/// Computes every search, fit and conversion again from the scores alone; surfaces follow from
/// pictures, so only their distances do. Returns the run file with
/// its answers computed anew. Throws Error(bad_data) where a search asks for a position that was
/// not measured next, or the file holds what no run can have: it or the program has changed.
/// `name` stands in the message.
RunFile rerun(const RunFile& file, std::string_view name);

/// Whether two run files came to the same answer: everything that a Focus holds, the fit and the
/// distance; of files before version 4, whose curves were judged by other rules, that the answers
/// agree within their sigmas. What no score tells (the rig, the window, times, what the lens said)
/// only the digest knows.
bool same_answer(const RunFile& a, const RunFile& b);

}  // namespace fathom
