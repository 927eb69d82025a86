// SPDX-License-Identifier: Apache-2.0
#include "mapping/sharper_end.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/quantile.hpp"

namespace fathom::mapping {
namespace {

/// Frames in the order of their positions.
std::vector<std::size_t> order_of(const std::vector<double>& positions) {
  std::vector<std::size_t> order(positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return positions[i]; });
  return order;
}

double mean_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Pearson's coefficient of correlation.
double correlation(const std::vector<float>& a, const std::vector<float>& b) {
  const double mean_a = mean_of(a), mean_b = mean_of(b);
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = a[i] - mean_a, y = b[i] - mean_b;
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

/// Of one picture, by how much a picture differs from the mean of its neighbours.
double noise_of(const std::vector<double>& detail) {
  constexpr double kSigmas = 1.4826 / 1.2247;  // of a median; of x - (before + after) / 2
  std::vector<double> off;
  for (std::size_t i = 1; i + 1 < detail.size(); ++i)
    off.push_back(std::abs(detail[i] - (detail[i - 1] + detail[i + 1]) / 2));
  return kSigmas * median(std::move(off));
}

}  // namespace

std::optional<TravelEnd> sharper_end(const CurveGrid& curves,
                                     const std::vector<double>& positions) {
  constexpr std::size_t kFewest = 5, kOfFrames = 16;
  constexpr double kSigmas = 8, kOfMost = 0.02, kShared = 0.3;
  if (positions.size() < kFewest || curves.frames.size() != positions.size()) return std::nullopt;
  const std::vector<std::size_t> order = order_of(positions);
  std::vector<double> detail;
  for (const std::size_t frame : order) detail.push_back(mean_of(curves.frames[frame]));
  const auto [least, most] = std::ranges::minmax_element(detail);
  const double rise = *most - *least;
  if (rise < kSigmas * noise_of(detail) || rise < kOfMost * *most) return std::nullopt;
  const auto place = static_cast<std::size_t>(most - detail.begin());
  // A lamp that drifts changes the noise, which is strong in other places of each picture.
  const std::size_t beside = place > 0 ? place - 1 : 1;
  if (correlation(curves.frames[order[place]], curves.frames[order[beside]]) < kShared)
    return std::nullopt;
  const std::size_t near = std::max<std::size_t>(1, positions.size() / kOfFrames);
  if (place < near) return TravelEnd::low;
  if (place + near >= positions.size()) return TravelEnd::high;
  return std::nullopt;
}

}  // namespace fathom::mapping
