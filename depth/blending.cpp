// SPDX-License-Identifier: Apache-2.0
#include "depth/blending.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "depth/placed.hpp"

namespace fathom::depth {
namespace {

/// Weight is energy to this power: half the amplitude has a part in 256 of the weight.
float weight_of(float energy) {
  const float square = energy * energy;
  return square * square;
}

}  // namespace

Plane shares_of(const Plane& energy, Plane& weights) {
  Plane shares(energy.width, energy.height);
  constexpr float kLeast = 1e-30F;  // a frame without any detail is a frame all the same
  for (std::size_t i = 0; i < energy.values.size(); ++i) {
    const float weight = weight_of(energy.values[i]) + kLeast;
    weights.values[i] += weight;
    shares.values[i] = weight / weights.values[i];
  }
  return shares;
}

Plane with_surroundings(const Plane& energy) {
  constexpr float kShare = 0.1F;
  const Plane near = smoothed(energy);
  const Plane coarse = smoothed(pooled(energy));
  Plane result = near;
  std::vector<float> scratch(static_cast<std::size_t>(coarse.width)),
      row(static_cast<std::size_t>(energy.width));
  for (int y = 0; y < result.height; ++y) {
    expand_row(coarse, y, result.width, scratch.data(), row.data());
    float* const to = result.row(y);
    for (int x = 0; x < result.width; ++x) to[x] += kShare * row[static_cast<std::size_t>(x)];
  }
  return result;
}

void doubt_clipped(const Frame& grey, Plane& energy) {
  constexpr float kDoubt = 0.1F;
  const bool is_narrow = grey.depth() == Depth::bits8;
  const std::uint32_t almost = is_narrow ? 247 : 63570;  // 97 % of white, as StackLight has it
  for (int y = 0; y < energy.height; ++y) {
    for (int x = 0; x < energy.width; ++x) {
      const int right = std::min((x + 1) * kCell, grey.width_px());
      const int bottom = std::min((y + 1) * kCell, grey.height_px());
      bool is_clipped = false;
      for (int v = y * kCell; v < bottom; ++v) {
        for (int u = x * kCell; u < right; ++u) is_clipped |= grey.at(u, v) >= almost;
      }
      if (is_clipped) energy.row(y)[x] *= kDoubt;
    }
  }
}

Plane shown_by(const Similarity& place, int width_px, int height_px) {
  constexpr double kRim_px = kCell, kMiddle = 0.5 * (kCell - 1);
  Plane shown(cells(width_px), cells(height_px));
  for (int y = 0; y < shown.height; ++y) {
    for (int x = 0; x < shown.width; ++x) {
      const Point there =
          place_of(place, x * kCell + kMiddle, y * kCell + kMiddle, width_px, height_px);
      const bool is_shown = there.x >= kRim_px && there.y >= kRim_px &&
                            there.x <= width_px - 1 - kRim_px && there.y <= height_px - 1 - kRim_px;
      shown.row(y)[x] = is_shown ? 1.0F : 0.0F;
    }
  }
  return shown;
}

void blend_row(const float* share, const float* value, float* stored, int width) {
  for (int x = 0; x < width; ++x) stored[x] += share[x] * (value[x] - stored[x]);
}

void blend_row(const float* share, const float* value, std::int16_t* stored, int width) {
  constexpr float kShift = 32768.5F;  // so that a cut is a rounding, below zero too
  for (int x = 0; x < width; ++x) {
    const auto old = static_cast<float>(stored[x]);
    const float mixed = old + share[x] * (value[x] - old);
    stored[x] = static_cast<std::int16_t>(static_cast<int>(mixed + kShift) - 32768);
  }
}

}  // namespace fathom::depth
