// SPDX-License-Identifier: Apache-2.0
#include "depth/ring_store.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace fathom::depth {
namespace {

/// Bits of a float below those that are kept.
constexpr int kDropped = 20;
constexpr std::uint32_t kHalf = 1u << (kDropped - 1);
constexpr float kLeast = 0x1p-22f;
constexpr std::uint32_t kBase = std::bit_cast<std::uint32_t>(kLeast) >> kDropped;
constexpr std::uint8_t kForgotten = 255, kLargest = 254;

std::uint8_t coded(float power) {
  if (!(power >= kLeast)) return 0;
  const std::uint32_t code =
      ((std::bit_cast<std::uint32_t>(power) + kHalf) >> kDropped) - kBase + 1;
  return static_cast<std::uint8_t>(std::min<std::uint32_t>(code, kLargest));
}

std::array<float, 256> decoded_table() {
  std::array<float, 256> table{};
  for (std::uint32_t code = 1; code <= kLargest; ++code) {
    table[code] = std::bit_cast<float>((code - 1 + kBase) << kDropped);
  }
  table[kForgotten] = std::numeric_limits<float>::quiet_NaN();
  return table;
}

}  // namespace

void RingStore::put(std::size_t frame, std::size_t first, std::span<const double> powers,
                    double unit) {
  if (frames_[frame].empty()) frames_[frame].resize(values_);
  std::uint8_t* const codes = frames_[frame].data() + first;
  const double factor = 1 / unit;
  for (std::size_t i = 0; i < powers.size(); ++i) {
    codes[i] = coded(static_cast<float>(powers[i] * factor));
  }
}

void RingStore::forget(std::size_t frame, std::size_t first, std::size_t count) {
  std::fill_n(frames_[frame].begin() + first, count, kForgotten);
}

void RingStore::take(std::size_t frame, std::size_t first, std::span<float> powers) const {
  static const std::array<float, 256> table = decoded_table();
  const std::uint8_t* const codes = frames_[frame].data() + first;
  for (std::size_t i = 0; i < powers.size(); ++i) powers[i] = table[codes[i]];
}

}  // namespace fathom::depth
