// SPDX-License-Identifier: Apache-2.0
#include "focus/peak_points.hpp"

#include <tuple>

namespace fathom {

PeakPoints points_of_peak(std::span<const Evaluation> curve, std::size_t best, double floor,
                          const ScoreNoise& noise) {
  constexpr double kUpper = 0.5, kMost = 0.75;
  constexpr std::size_t kPlenty = 6, kFewest = 4;
  const double dip = std::max({floor, best > 0 ? curve.front().score : floor,
                               best + 1 < curve.size() ? curve.back().score : floor});
  const double top = curve[best].score, prominence = top - dip;
  auto [first, last] = reach(curve, best, top - kUpper * prominence);
  if (last - first + 1 < kPlenty) {
    std::tie(first, last) = reach(curve, best, top - kMost * prominence);
  }
  if (first == best && first > 0) --first;
  if (last == best && last + 1 < curve.size()) ++last;
  while (last - first + 1 < kFewest && (first > 0 || last + 1 < curve.size())) {
    const bool can_left = first > 0, can_right = last + 1 < curve.size();
    const bool left =
        can_left && (!can_right || curve[best].position - curve[first - 1].position <=
                                       curve[last + 1].position - curve[best].position);
    left ? --first : ++last;
  }
  const auto part = curve.subspan(first, last - first + 1);
  return {.evaluations = {part.begin(), part.end()},
          .best = best - first,
          .floor = floor,
          .noise = noise};
}

}  // namespace fathom
