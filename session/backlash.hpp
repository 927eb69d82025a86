// SPDX-License-Identifier: Apache-2.0
// How far a focus seems to shift with the direction that the lens comes from: the play that is left
// of its gears.
#pragma once

#include <functional>

#include "../focus/peak.hpp"
#include "hill.hpp"
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

/// How long to wait after a move of so far, in the lens's unit, says that it is over, ms.
using RestAfter = std::function<double(double distance)>;

/// Sweeps upward over a hill, and downward until the same peak has gone by, however far below it
/// that is; play of up to a tenth of the travel is found. Fits both peaks. hill: seen going upward.
/// Throws as Rig::measure, Error(bad_data) where a way has no peak to fit.
Backlash measure_backlash(Rig& rig, const Hill& hill, const RestAfter& rest_ms);

}  // namespace fathom
