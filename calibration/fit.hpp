// SPDX-License-Identifier: Apache-2.0
// How a calibration curve is fitted: least squares of positions, robust to outliers.
#pragma once

#include <span>
#include <vector>

#include "curve.hpp"

namespace fathom {

/// A fitted curve and what is known of it.
struct CurveFit {
  CalibrationCurve curve;
  std::vector<bool> left_out;  ///< Which points are outliers and had no say.
  int freedom = 0;             ///< Points that had, less parameters.
  double scatter = 0;  ///< Root of (sum of squared position residuals / freedom); 0 without any.
  /// (J'J)^-1 of the positions by b: times scatter^2 it is the covariance of b.
  CalibrationCurve::Matrix spread = {};

  /// The variance of the curve's position at a distance, in squares of the scatter.
  double leverage(double distance_mm) const {
    return curve.variance(spread, curve.gradient(distance_mm));
  }
};

/// Distances are known and focused positions scatter, alike everywhere; so the squares of position
/// residuals are summed. A least median of squares start finds outliers: points beyond 5 robust
/// sigmas of it that the least squares curve of the rest rejects too, with a chance of 1 % to
/// reject any of clean data; none where fewer than 3 points are to spare, and none where more than
/// a quarter of the points stand out, which is the curve's fault. Throws Error(bad_argument) as
/// Calibration::fit.
CurveFit fit_curve(CalibrationModel model, std::span<const CalibrationPoint> points);

}  // namespace fathom
