// SPDX-License-Identifier: Apache-2.0
#include "depth/growth_fit.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::depth {

void GrowthFit::add(std::size_t frame, double ratio, double sigma) {
  pairs_.push_back({frame, ratio, sigma});
  constexpr int kSteps = 8;
  for (int step = 0; step < kSteps; ++step) fit();
}

namespace {

/// Of a value so far off: least squares, or less beyond two sigmas.
double weight_of(double off, double sigma) {
  constexpr double kHuber = 2;
  return 1 / (sigma * sigma) / std::max(std::abs(off) / (kHuber * sigma), 1.0);
}

}  // namespace

void GrowthFit::fit() {
  const double from_law = law_.per_unit - per_unit_;
  double weights = weight_of(from_law, law_.sigma), sum = weights * from_law;
  for (const Pair& pair : pairs_) {
    const double before = scale(pair.frame - 1);
    const double slope = (from_first(pair.frame) - from_first(pair.frame - 1)) / (before * before);
    const double off = pair.ratio - ratio(pair.frame);
    const double weight = weight_of(off, pair.sigma);
    weights += weight * slope * slope;
    sum += weight * slope * off;
  }
  per_unit_ += sum / weights;
}

}  // namespace fathom::depth
