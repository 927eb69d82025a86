// SPDX-License-Identifier: Apache-2.0
#include "focus/second_look.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fathom {
namespace {

/// Slope of the peak's shape there, per half width and as a part of the height: near enough for
/// every shape, and steepest where a score tells most of a shift.
double slope_at(const Peak& peak, double position) {
  const double z = (position - peak.position) / peak.half_width;
  return -2 * z / ((1 + z * z) * (1 + z * z));
}

/// The evaluation on this side of the peak (-1 below, 1 above) where a shift would show best: on its
/// slope, and seen long ago.
const Evaluation* telling(const SearchTrace& trace, const Peak& peak, int side) {
  constexpr double kOnSlope = 0.1;
  const Evaluation* best = nullptr;
  double most = 0;
  const auto count = static_cast<double>(trace.evaluations().size());
  for (const Evaluation& e : trace.evaluations()) {
    const double slope = side * -slope_at(peak, e.position);
    const double tells = slope * (count + 1 - e.loop);
    if (slope < kOnSlope || tells <= most) continue;
    best = &e;
    most = tells;
  }
  return best;
}

const Evaluation* seen_at(const FocusCurve& curve, double position) {
  const auto& all = curve.evaluations();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Evaluation& e) {
    return e.position == position && e.loop > 0;
  });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace

void look_again(SearchTrace& trace, const Peak& peak) {
  std::vector<double> places = {best_of(trace.evaluations()).position};
  if (peak.half_width > 0) {
    for (const int side : {1, -1}) {
      if (const Evaluation* slope = telling(trace, peak, side)) places.push_back(slope->position);
    }
  }
  // In the order in which the way is shortest.
  std::sort(places.begin(), places.end());
  const double here = trace.evaluations().back().position;
  if (std::abs(here - places.back()) < std::abs(here - places.front()))
    std::reverse(places.begin(), places.end());
  for (const double place : places) trace.look_again(place);
}

SecondLooks compare_looks(std::span<const Evaluation> looks, const FocusCurve& curve,
                          const Peak& peak, const Scatter& scatter) {
  constexpr double kUnsteady = 0.004;  // of the height: what flickers within a picture
  constexpr double kShift = 0.012;  // half widths: a lens comes to rest so near to the same place
  constexpr double kOnSlope = 0.1;
  const double noise = noise_of(scatter, curve).sigma, height = peak.score - curve.floor();
  double squares = 0, count = 0;
  SecondLooks result;
  for (const Evaluation& look : looks) {
    const Evaluation* const before = seen_at(curve, look.position);
    if (before == nullptr) continue;
    const double change = std::abs(look.score - before->score);
    const double steep = peak.half_width > 0 ? std::abs(slope_at(peak, look.position)) : 0;
    const double usual = std::hypot(std::sqrt(2.0) * noise, (kUnsteady + kShift * steep) * height);
    squares += usual > 0 ? change * change / (usual * usual) : 0;
    ++count;
    if (steep < kOnSlope || !(height > 0)) continue;
    const double shift = std::max(0.0, change - 2 * usual) / (steep * height) * peak.half_width;
    result.shift = std::max(result.shift, shift);
  }
  // A chance of some 1 in 1000, by Wilson and Hilferty's likeness of chi-squared, and a deviation
  // that is known to a fifth.
  constexpr double kSigmas = 4;
  const double root = 1 - 2 / (9 * count) + kSigmas * std::sqrt(2 / (9 * count));
  result.agree = count == 0 || squares < count * root * root * root;
  return result;
}

}  // namespace fathom
