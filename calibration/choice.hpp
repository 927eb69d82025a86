// SPDX-License-Identifier: Apache-2.0
// Which curve: the one that predicts best what it has not seen.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calibration.hpp"

namespace fathom {

/// A model and how well it predicts.
struct ModelTrial {
  CalibrationModel model = CalibrationModel::inverse;
  double error = 0;      ///< Root mean square of (predicted - actual) / actual; infinity: no fit.
  double r_squared = 0;  ///< Of the fit to all points; NaN without one.
  std::string problem;   ///< Why there is no fit, or empty.
};

/// What was tried and what came out.
struct ModelChoice {
  std::vector<ModelTrial> trials;                     ///< In the order of calibration_models().
  CalibrationModel best = CalibrationModel::inverse;  ///< Of the lowest error.
  /// The one to take: the best, or one with fewer parameters whose error is larger by no more than
  /// chance.
  CalibrationModel model = CalibrationModel::inverse;
};

/// Cross-validation: all points of one distance leave together (beyond 20 distances, every
/// twentieth), the rest is fitted, and the distance of those that left is predicted. The lowest
/// error wins, but a model with fewer parameters whose error is within 5 % of it, or that it beats
/// by less than one standard error over the distances, is preferred. A point that the model with
/// the lowest median error leaves out as an outlier counts for none, and is in no fit. Throws Error(bad_argument)
/// where no model can be judged: fewer than 3 distances, or points as for Calibration::fit.
ModelChoice choose_calibration_model(std::span<const CalibrationPoint> points);

}  // namespace fathom
