// SPDX-License-Identifier: Apache-2.0
// How far a focus seems to shift with the direction that the lens comes from: the play that is left
// of its gears.
#pragma once

#include <span>

#include "../focus/peak.hpp"
#include "rig.hpp"

namespace fathom {

/// The same peak, seen going upward and going downward.
struct Backlash {
  Peak up;
  Peak down;
  /// A lens that lags behind by this much on its way down shows its focus that much lower; 0 for a
  /// lens that takes up its play. In the lens's unit; negative by chance, or where the lens runs
  /// ahead.
  double play() const { return up.position - down.position; }
  double sigma() const;
  /// Whether that is more than chance.
  bool is_certain() const;
  /// What the rig file should say so that the lens takes it up: the play and two sigmas, in whole
  /// steps of `resolution`; 0 where there is none for certain.
  double suggestion(double resolution) const;
};

/// Positions of one way up; downward they are taken in reverse.
inline constexpr int kBacklashPositions = 9;

/// Sweeps upward and downward over `reach` to either side of a focus, and fits both peaks. A score
/// is taken `rest_ms` after the lens says that it has settled. Throws as Rig::measure,
/// Error(bad_data) where a way has no peak to fit.
Backlash measure_backlash(Rig& rig, double focus, double reach, double floor, double rest_ms);

}  // namespace fathom
