// SPDX-License-Identifier: Apache-2.0
// One search or one sweep on a rig: what was asked, what was measured, what it came to.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "../focus/focus.hpp"
#include "../focus/moving_peak.hpp"
#include "measurement.hpp"

namespace fathom {

/// All that a search or a sweep on a rig came to.
struct Run {
  std::optional<double> target_mm;    ///< Known distance of the target, if any.
  std::optional<FocusLimits> limits;  ///< Absent for a sweep, which only evaluates.
  double repeat_scatter = 0;
  double lost_part = 0;  ///< Of the camera's frames, 0..1: dropped, or damaged.
  /// Where the lens stood when it began, and when that was on the rig's clock; absent in old files.
  std::optional<double> start_position;
  std::optional<std::int64_t> started_ns;
  int repeats = 0;  ///< Frames scored beforehand, to learn how far a score repeats.
  std::optional<Resemblance> resemblance;  ///< Of the best picture to another, if compared.
  std::optional<FirstLook> first_look;     ///< At the picture of start_position, if compared.
  bool tracks = false;   ///< Began where the run before it ended (focus/track.hpp),
  bool by_time = false;  ///< and took the target for one that may move.
  std::vector<Measurement> measurements;  ///< In the order in which they were made.
  std::optional<Focus> focus;  ///< The answer; absent for a sweep or an unfinished search.
  /// Of the window in the sharpest picture of a search (calibration/likeness.hpp); empty where
  /// nobody looked.
  std::vector<double> spectrum;

  std::vector<Evaluation> evaluations() const;
  /// Those of a lens at rest.
  std::vector<Evaluation> evaluations_at_rest() const;
  /// The same with their times.
  std::vector<Sighting> sightings() const;
};

/// What a run cost.
struct Journey {
  double travel =
      0;  ///< Of the lens from its start to the end of the search, its unit; not the way back.
  double rig_seconds = 0;  ///< On the rig's clock: moves, waits and exposures.
  int frames = 0;
  int on_the_way = 0;  ///< Of the frames: those that the lens did not halt for.
};
Journey journey_of(const Run& run);
/// Of several runs together.
Journey journey_of(std::span<const Run> runs);

/// The middle of the exposure, s, on the rig's clock.
double middle_s(const Measurement& measurement);

}  // namespace fathom
