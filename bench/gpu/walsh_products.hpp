// SPDX-License-Identifier: Apache-2.0
// The Walsh score of a 64 x 64 window of 8 bits as exact products of int8 matrices with 32-bit sums, as
// tensor cores compute them: a model of a kernel, in plain C++ (docs/performance.md, "Walsh by matrix
// products").
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>

namespace fathom::bench {

inline constexpr int kSide = 64;
inline constexpr int kPixels = kSide * kSide;

/// What a window costs.
struct ProductCounts {
  std::int64_t instructions = 0;  ///< Products of tiles: mma.m16n8k32.
  std::int64_t products = 0;      ///< int8 x int8.
};

/// Products of tiles, 16 x 32 by 32 x 8, into 32-bit sums. Throws std::overflow_error where a sum
/// does not fit: the hardware would wrap without a word.
class TileProducts {
 public:
  /// sums += left * right: 64 x 64 each, row by row.
  void add(std::span<const std::int8_t, kPixels> left, std::span<const std::int8_t, kPixels> right,
           std::span<std::int32_t, kPixels> sums);
  const ProductCounts& counts() const { return counts_; }

 private:
  ProductCounts counts_;
};

/// SUM |T(i,j)| (i^2 + j^2), T = H P H^T in order of sequency: N^6 times the score. pixels: 64 x 64.
std::int64_t walsh_sum(std::span<const std::uint8_t, kPixels> pixels, TileProducts& tiles);

}  // namespace fathom::bench
