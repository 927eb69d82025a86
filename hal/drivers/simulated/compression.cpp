// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/compression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace fathom::simulated {
namespace {

constexpr int kSide = 8;
using Block = std::array<double, kSide * kSide>;

/// Steps of luminance at quality 50 (ITU-T T.81, table K.1); quality 90 has a fifth of them.
constexpr int kSteps[kSide * kSide] = {
    16, 11, 10, 16, 24,  40,  51,  61,  12, 12, 14, 19, 26,  58,  60,  55,   //
    14, 13, 16, 24, 40,  57,  69,  56,  14, 17, 22, 29, 51,  87,  80,  62,   //
    18, 22, 37, 56, 68,  109, 103, 77,  24, 35, 55, 64, 81,  104, 113, 92,   //
    49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99};  //
constexpr double kQuality = 0.2;

/// Orthonormal cosines: row k is that of frequency k.
const Block& cosines() {
  static const Block table = [] {
    Block rows{};
    for (int k = 0; k < kSide; ++k) {
      for (int x = 0; x < kSide; ++x) {
        rows[k * kSide + x] = std::sqrt((k == 0 ? 1.0 : 2.0) / kSide) *
                              std::cos(std::numbers::pi * k * (x + 0.5) / kSide);
      }
    }
    return rows;
  }();
  return table;
}

/// Transforms the rows and transposes: twice of it is the whole. `back`: the inverse.
Block half(const Block& block, bool back) {
  const Block& table = cosines();
  Block result{};
  for (int row = 0; row < kSide; ++row) {
    for (int k = 0; k < kSide; ++k) {
      double sum = 0;
      for (int x = 0; x < kSide; ++x)
        sum += block[row * kSide + x] * table[back ? x * kSide + k : k * kSide + x];
      result[k * kSide + row] = sum;
    }
  }
  return result;
}

}  // namespace

void compress(std::span<std::uint8_t> pixels, int width_px) {
  const int height_px = static_cast<int>(pixels.size()) / width_px;
  for (int top = 0; top + kSide <= height_px; top += kSide) {
    for (int left = 0; left + kSide <= width_px; left += kSide) {
      std::uint8_t* const corner = pixels.data() + static_cast<std::size_t>(top) * width_px + left;
      Block block;
      for (int i = 0; i < kSide * kSide; ++i)
        block[i] = corner[i / kSide * width_px + i % kSide] - 128.0;
      block = half(half(block, false), false);
      for (int i = 0; i < kSide * kSide; ++i) {
        const double step = std::max(1.0, std::floor(kSteps[i] * kQuality + 0.5));
        block[i] = step * std::nearbyint(block[i] / step);
      }
      block = half(half(block, true), true);
      for (int i = 0; i < kSide * kSide; ++i) {
        corner[i / kSide * width_px + i % kSide] =
            static_cast<std::uint8_t>(std::clamp(std::nearbyint(block[i] + 128), 0.0, 255.0));
      }
    }
  }
}

}  // namespace fathom::simulated
