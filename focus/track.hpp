// SPDX-License-Identifier: Apache-2.0
// Following a target that moves: the next focus is looked for where the last one will be.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "focus.hpp"
#include "moving_peak.hpp"

namespace fathom {

/// What lies farther from a peak than this, in half widths, is floor.
inline constexpr double kPeakReach = 3;

/// What a search saw far from its peak.
std::vector<Evaluation> floor_seen_by(const Focus& before);

/// What following asks of a rig, or of a run that is computed again.
struct TimedObjective {
  Objective objective;
  /// When the last score was taken: middle of its exposure, s, on the clock of the sightings.
  std::function<double()> time_s;
};

/// The focus again, with its speed: both slopes and the top of the last peak, each where it will be
/// by then, and a few places more where that is not enough. Position and sigma are those at the
/// last evaluation. Where the peak is not found, or its scores tell no one story, everything is
/// searched, and what was found is followed a few places more: nothing is believed of a single
/// look.
/// before: the last focus; seen: the evaluations that it came from.
Focus track_focus(const TimedObjective& timed, const FocusLimits& limits, const MetricSpec& spec,
                  double repeat_scatter, const Focus& before, std::span<const Sighting> seen);

/// The same of a target that stands, as it was done before evaluations had times: for runs that
/// are computed again.
Focus track_still_focus(const Objective& objective, const FocusLimits& limits,
                        const MetricSpec& spec, double repeat_scatter, const Focus& before);

}  // namespace fathom
