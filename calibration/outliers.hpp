// SPDX-License-Identifier: Apache-2.0
// Which points of a calibration are suspect, by the least median of squares (Rousseeuw 1984).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "curve.hpp"

namespace fathom {

/// The curve that solves the linear form of these points best; nothing where they determine none.
std::optional<CalibrationCurve::Vector> linear_start(const CalibrationCurve& shape,
                                                     std::span<const CalibrationPoint> points);

/// What the least median of squares says.
struct Suspects {
  std::vector<bool> outlier;
  std::optional<CalibrationCurve::Vector> start;  ///< A curve that outliers did not spoil.
};

/// Points farther than 5 robust sigmas from the curve through as many points as it has parameters
/// that has the least median of squared position residuals. None for fewer than 3 points to spare,
/// none where they are more than a quarter.
Suspects find_suspects(const CalibrationCurve& shape, std::span<const CalibrationPoint> points);

/// What the scatter of a position cannot be below, in the lens's unit: that of rounding to whole
/// numbers, if all are whole, else of arithmetic.
double smallest_scatter(std::span<const CalibrationPoint> points);

/// The points that are not left out.
std::vector<CalibrationPoint> without(std::span<const CalibrationPoint> points,
                                      const std::vector<bool>& left_out);

}  // namespace fathom
