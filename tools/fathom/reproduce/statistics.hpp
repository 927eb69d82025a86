// SPDX-License-Identifier: Apache-2.0
// The few statistics that the thesis' experiments are judged by.
#pragma once

#include <span>

namespace fathom::reproduce {

/// Mean, spread and extremes of some numbers. All 0 for none.
struct Summary {
  int count = 0;
  double mean = 0;
  double sd = 0;  ///< Sample standard deviation; 0 for fewer than two.
  double least = 0, most = 0;

  /// Half of the range as a part of the mean: the thesis' "+-2 %".
  double half_range_part() const { return mean == 0 ? 0 : (most - least) / 2 / mean; }
};
Summary summarise(std::span<const double> values);

/// Y = intercept + slope X by least squares of Y.
struct Line {
  double intercept = 0, slope = 0;
  double r_squared = 0;  ///< Coefficient of determination.

  double at(double x) const { return intercept + slope * x; }
};
/// Throws Error(bad_argument) unless there are as many x as y and two different x.
Line fit_line(std::span<const double> x, std::span<const double> y);

/// 1 - (sum of squared residuals) / (sum of squares about the mean of y).
double r_squared_of(std::span<const double> y, std::span<const double> fitted);

/// How far neighbouring samples of an evenly sampled curve stand off the straight line through
/// their neighbours, as the standard deviation of one sample: the root of the mean of
/// (y[i-1] - 2 y[i] + y[i+1])^2 / 6 (Gasser, Sroka & Jennen-Steinmetz 1986). A slope adds nothing,
/// independent noise adds its deviation. 0 for fewer than three samples.
double roughness(std::span<const double> y);

/// A mean ratio of positive numbers with its 95 % confidence interval.
struct Ratio {
  int count = 0;
  double value = 0, low = 0, high = 0;
};
/// Of logarithms, by Student's t. An interval without width for a single ratio.
Ratio mean_ratio(std::span<const double> ratios);

}  // namespace fathom::reproduce
