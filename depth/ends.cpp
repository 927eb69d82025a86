// SPDX-License-Identifier: Apache-2.0
#include "depth/ends.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace fathom::depth {

Ends::Ends(std::span<const double> positions, double near)
    : positions_(positions.begin(), positions.end()),
      low_(*std::ranges::min_element(positions)),
      high_(*std::ranges::max_element(positions)),
      near_(near) {}

/// Of the frames that are nearer than `near`, and else of the nearest one.
double Ends::mean_near(std::span<const float> detail, double place, double near) const {
  double sum = 0, nearest = 0, distance = std::numeric_limits<double>::max();
  int count = 0;
  for (std::size_t i = 0; i < detail.size(); ++i) {
    const double away = std::abs(positions_[i] - place);
    if (away < distance) {
      distance = away;
      nearest = detail[i];
    }
    if (away > near) continue;
    sum += detail[i];
    ++count;
  }
  return count > 0 ? sum / count : nearest;
}

bool Ends::lie_below(std::span<const float> detail, double place) const {
  constexpr double kAbove = 0.15;
  const double mean = std::accumulate(detail.begin(), detail.end(), 0.0) /
                      static_cast<double>(std::max<std::size_t>(detail.size(), 1));
  return std::ranges::all_of(std::array{low_, high_}, [&](double end) {
    // What is near to both would count twice.
    const double near = std::min(near_, std::abs(place - end) / 2);
    const double here = mean_near(detail, place, near);
    return here - mean_near(detail, end, near) >= kAbove * (here - mean) && here > mean;
  });
}

bool Ends::hold(std::span<const float> detail) const {
  const auto greatest = std::ranges::max_element(detail) - detail.begin();
  return lie_below(detail, positions_[static_cast<std::size_t>(greatest)]);
}

}  // namespace fathom::depth
