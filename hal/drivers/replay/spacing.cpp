// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/replay/spacing.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::replay {

double smallest_gap(std::span<const double> positions) {
  double smallest = 1;
  for (std::size_t i = 1; i < positions.size(); ++i) {
    const double gap = positions[i] - positions[i - 1];
    smallest = i == 1 ? gap : std::min(smallest, gap);
  }
  return smallest;
}

double coarse_spacing_of(std::span<const double> positions) {
  constexpr double kCoarseSamples = 128;
  const double gap = smallest_gap(positions);
  if (static_cast<double>(positions.size()) <= kCoarseSamples) return gap;
  const double travel = positions.back() - positions.front();
  return std::ceil(travel / kCoarseSamples / gap) * gap;
}

}  // namespace fathom::replay
