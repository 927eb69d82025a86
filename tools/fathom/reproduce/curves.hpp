// SPDX-License-Identifier: Apache-2.0
// Figures 11 to 13: focus quality against lens position, by all three transforms.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/fathom/reproduce/measuring.hpp"
#include "tools/fathom/reproduce/statistics.hpp"

namespace fathom::reproduce {

/// From so many steps on the lens is far from focus.
inline constexpr double kFarSteps = 150;
/// Between samples of the far floor.
inline constexpr int kFarStep = 10;
inline constexpr double kCurveDistances[] = {1500, 2000, 2500};

using ThreeNumbers = std::array<double, kTransformCount>;

struct MeasuredCurves {
  double distance_mm = 0;
  double truth = 0;  ///< The true focus, steps.
  std::vector<double> positions;
  std::vector<ThreeNumbers> scores;  ///< Each as a part of its curve's highest.
  ThreeNumbers best{};               ///< Position of the highest score.
  ThreeNumbers fitted{};             ///< Position of the fitted peak.
  std::array<std::size_t, kTransformCount> lobes{};
};

/// Far from focus on one rig.
struct FarFloor {
  std::string target;
  double distance_mm = 0;
  ThreeNumbers level{};     ///< Mean score, part of the peak.
  ThreeNumbers of_peak{};   ///< Roughness, part of the peak.
  ThreeNumbers of_level{};  ///< Roughness, part of the level.
};

struct Curves {
  std::vector<MeasuredCurves> curves;
  std::vector<FarFloor> floors;
  Ratio paley_of_peak, sequency_of_peak;    ///< FFT's roughness over Walsh's.
  Ratio paley_of_level, sequency_of_level;  ///< The same, each relative to its own level.
};

/// Adds what must be measured; `curves` must stay where it is until that is done.
void plan_curves(Curves& curves, const Effort& effort, const ShouldStop& should_stop, Tasks& tasks);
/// After the tasks: what follows from the measurements.
void finish_curves(Curves& curves);

}  // namespace fathom::reproduce
