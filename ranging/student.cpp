// SPDX-License-Identifier: Apache-2.0
#include "ranging/student.hpp"

#include <cmath>
#include <limits>
#include <unsupported/Eigen/SpecialFunctions>

namespace fathom {
namespace {

/// P(|T| > t) = I_x(freedom / 2, 1 / 2) with x = freedom / (freedom + t^2).
double beyond(double t, double freedom) {
  using Value = Eigen::Array<double, 1, 1>;
  return Eigen::betainc(Value(freedom / 2), Value(0.5), Value(freedom / (freedom + t * t))).value();
}

}  // namespace

// Eigen has the incomplete beta function, and only headers come with it; Boost.Math, which has the
// quantile too, would install 138 MB for this one number.
double student_t_within(double probability, double freedom) {
  constexpr double kLargest = 1e12;
  double low = 0, high = 1;
  while (beyond(high, freedom) > 1 - probability) {
    low = high;
    high *= 2;
    if (high > kLargest) return std::numeric_limits<double>::infinity();
  }
  for (int i = 0; i < 100 && high - low > 1e-14 * high; ++i) {
    const double middle = (low + high) / 2;
    (beyond(middle, freedom) > 1 - probability ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace fathom
