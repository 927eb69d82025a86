// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/random.hpp"

#include <cmath>

namespace fathom::simulated {

/// Marsaglia's polar method: two numbers from one point in the unit circle.
double Random::gaussian() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  double x, y, squared;
  do {
    x = uniform(-1, 1);
    y = uniform(-1, 1);
    squared = x * x + y * y;
  } while (squared >= 1 || squared == 0);
  const double scale = std::sqrt(-2 * std::log(squared) / squared);
  spare_ = y * scale;
  has_spare_ = true;
  return x * scale;
}

}  // namespace fathom::simulated
