// SPDX-License-Identifier: Apache-2.0
#include "session/saturation.hpp"

#include <algorithm>
#include <cmath>

namespace fathom {
namespace {

/// The highest grey value of a camera whose highest pixel is `highest`.
std::uint32_t full_scale(Depth depth, std::uint32_t highest) {
  if (depth == Depth::bits8) return 255;
  for (const std::uint32_t scale : {1023u, 4095u, 16383u}) {
    if (highest <= scale) return scale;
  }
  return 65535;
}

}  // namespace

double saturated_part(const Frame& frame, const Window& window) {
  std::uint32_t highest = 0;
  int count = 0;
  for (int y = window.y; y < window.y + window.n; ++y) {
    for (int x = window.x; x < window.x + window.n; ++x) {
      const std::uint32_t grey = frame.at(x, y);
      if (grey > highest) highest = grey, count = 0;
      count += grey == highest ? 1 : 0;
    }
  }
  if (highest < full_scale(frame.depth(), highest)) return 0;
  return static_cast<double>(count) / (static_cast<double>(window.n) * window.n);
}

std::optional<Saturation> saturation_at(std::span<const Measurement> measurements,
                                        double position) {
  constexpr double kHarmless = 0.01;
  const auto away = [position](const Measurement& m) { return std::abs(m.position - position); };
  const auto nearest = std::min_element(
      measurements.begin(), measurements.end(),
      [&](const Measurement& a, const Measurement& b) { return away(a) < away(b); });
  if (nearest == measurements.end() || nearest->saturated <= kHarmless) return std::nullopt;
  return Saturation{nearest->saturated, nearest->position};
}

}  // namespace fathom
