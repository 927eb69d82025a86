// SPDX-License-Identifier: Apache-2.0
// The thesis' way to a distance and this one beside each other: what they cost, and how much noise
// they stand.
#pragma once

#include <vector>

#include "tools/fathom/reproduce/trials.hpp"

namespace fathom::reproduce {

/// One way, on the same scenes as the others.
struct Way {
  Trial trial;

  // Of finish_ways():
  Summary travel = {}, rig_seconds = {}, frames = {};
  double times_direct = 0;   ///< All travel over all direct ways from start to focus.
  double allowed_s = 0;      ///< Mean of 1.5 times the direct way at 25 steps/s, and 3 s.
  int close = 0;             ///< Answers within 0.5 % of the distance.
  double off_in_sigmas = 0;  ///< rms of (position - focus) / sigma of the answers.
  double off_steps = 0;      ///< rms of (position - focus) of the answers.
};

/// Both ways with so much noise.
struct NoiseLevel {
  double times = 1;  ///< Of the rig's noise.
  Trial coarse, spectral;

  double decibels() const;
};

struct Ways {
  Way golden, coarse, spectral, three_frames, three_near;
  std::vector<NoiseLevel> noise;
  Trial blank;  ///< A blank card, by spectra, with all those noises.

  std::vector<const Way*> all() const {
    return {&golden, &coarse, &spectral, &three_frames, &three_near};
  }
};
inline constexpr double kNear = 200;  ///< Steps from the focus where three_near begins at most.

/// Answers that are off by less than half of the depth of field.
int right_of(const Trial& trial);
/// The highest noise, dB over the rig's, up to which nine of ten runs are right; below 0 if that is
/// none. trial: of a level.
double noise_stood(const Ways& ways, Trial NoiseLevel::*trial);
/// The level with so much noise.
const NoiseLevel& level_at(const Ways& ways, double times);

void plan_ways(Ways& ways, const Effort& effort, const ShouldStop& should_stop, Tasks& tasks);
void finish_ways(Ways& ways, const Calibrations& calibrations);

}  // namespace fathom::reproduce
