// SPDX-License-Identifier: Apache-2.0
// Calibration points of known curves, with Gaussian scatter of the positions where asked for.
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "calibration/calibration.hpp"

namespace fathom::test {

/// The position that focuses a distance.
using Truth = std::function<double(double distance_mm)>;

/// The thesis rig: f = 135 mm, position = 1.3008e6 / (distance - f).
inline double thesis_rig(double distance_mm) { return 1.3008e6 / (distance_mm - 135); }
/// The same lens, counted from 300 steps before its focus on infinity.
inline double offset_rig(double distance_mm) { return 300 + thesis_rig(distance_mm); }
/// The same lens, counted from its near end: positions grow toward far.
inline double reversed_rig(double distance_mm) { return 2000 - thesis_rig(distance_mm); }
/// distance = 1.2e6 position^-0.95.
inline double power_rig(double distance_mm) { return std::pow(distance_mm / 1.2e6, -1 / 0.95); }
/// distance = 3 position^1.05.
inline double rising_power_rig(double distance_mm) { return std::pow(distance_mm / 3, 1 / 1.05); }

/// A lens of 0.0004 dioptres a unit that focuses on 5 m at 0.
inline double dioptre_rig(double distance_mm) { return (1000 / distance_mm - 0.2) / 0.0004; }

/// `count` distances from 1400 to 2600 mm.
inline std::vector<CalibrationPoint> points_of(const Truth& truth, int count, double scatter = 0,
                                               unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> error(0, 1);
  std::vector<CalibrationPoint> points;
  for (int i = 0; i < count; ++i) {
    const double distance = 1400 + 1200.0 * i / (count - 1);
    points.push_back({truth(distance) + (scatter > 0 ? scatter * error(random) : 0), distance});
  }
  return points;
}

inline int count_left_out(const Calibration& fit) {
  int count = 0;
  for (std::size_t i = 0; i < fit.points().size(); ++i) count += fit.left_out(i) ? 1 : 0;
  return count;
}

/// A model with a rig that it describes exactly.
struct TrueModel {
  CalibrationModel model;
  Truth truth;
  std::vector<double> parameters;  ///< As CalibrationCurve::natural names them.
};

inline std::vector<TrueModel> true_models() {
  constexpr double scale = 135.0 * 135 / 1.3008e6;
  return {{CalibrationModel::inverse, thesis_rig, {135, 1.3008e6}},
          {CalibrationModel::power, power_rig, {1.2e6, -0.95}},
          {CalibrationModel::power, rising_power_rig, {3, 1.05}},
          {CalibrationModel::dioptre, dioptre_rig, {0.2, 0.0004}},
          {CalibrationModel::thin_lens, offset_rig, {135, 300, scale}},
          {CalibrationModel::thin_lens, reversed_rig, {135, 2000, -scale}}};
}

}  // namespace fathom::test
