// SPDX-License-Identifier: Apache-2.0
#include "session/saturation.hpp"

#include <algorithm>
#include <cmath>

#include "session/greys.hpp"

namespace fathom {
std::uint32_t full_scale(Depth depth, std::uint32_t highest) {
  if (depth == Depth::bits8) return 255;
  constexpr std::uint32_t kScales[] = {
      1023,      4095,      16383,      // 10, 12 and 14 bits in the low bits,
      1023 << 6, 4095 << 4, 16383 << 2  // and in the high ones
  };
  for (const std::uint32_t scale : kScales) {
    if (highest <= scale) return scale;
  }
  return 65535;
}

double saturated_part(const Frame& frame, const Window& window) {
  std::uint32_t highest = 0;
  for_each_row(frame, window, [&](const auto* row) {
    auto of_row = row[0];
    for (int x = 1; x < window.n; ++x) of_row = std::max(of_row, row[x]);
    highest = std::max<std::uint32_t>(highest, of_row);
  });
  if (highest < full_scale(frame.depth(), highest)) return 0;
  int count = 0;
  for_each_row(frame, window, [&](const auto* row) {
    for (int x = 0; x < window.n; ++x) count += row[x] == highest ? 1 : 0;
  });
  return static_cast<double>(count) / (static_cast<double>(window.n) * window.n);
}

std::optional<Saturation> saturation_at(std::span<const Measurement> measurements,
                                        double position) {
  constexpr double kHarmless = 0.01;
  const auto away = [position](const Measurement& m) { return std::abs(m.position - position); };
  const auto nearest = std::min_element(
      measurements.begin(), measurements.end(),
      [&](const Measurement& a, const Measurement& b) { return away(a) < away(b); });
  if (nearest == measurements.end() || nearest->picture.saturated <= kHarmless) return std::nullopt;
  return Saturation{nearest->picture.saturated, nearest->position};
}

}  // namespace fathom
