// SPDX-License-Identifier: Apache-2.0
#include "session/part_brightness.hpp"

#include <cstddef>
#include <cstdint>

namespace fathom {
namespace {

/// Parts overlap by half, so they are made of quarters of the side, four across.
constexpr int kCellsAcross = kPartsAcross + 1;

std::uint64_t sum_of_cell(const Frame& frame, const Window& window, int row, int column) {
  const int side = window.n / kCellsAcross;
  const int left = window.x + column * side, top = window.y + row * side;
  std::uint64_t sum = 0;
  for (int y = top; y < top + side; ++y) {
    for (int x = left; x < left + side; ++x) sum += frame.at(x, y);
  }
  return sum;
}

}  // namespace

std::array<double, kParts> part_brightness(const Frame& frame, const Window& window) {
  std::array<double, kParts> sums{};
  for (int row = 0; row < kCellsAcross; ++row) {
    for (int column = 0; column < kCellsAcross; ++column) {
      const auto cell = static_cast<double>(sum_of_cell(frame, window, row, column));
      for (const int r : {row - 1, row}) {
        for (const int c : {column - 1, column}) {
          const bool is_part = r >= 0 && c >= 0 && r < kPartsAcross && c < kPartsAcross;
          if (is_part) sums[static_cast<std::size_t>(r * kPartsAcross + c)] += cell;
        }
      }
    }
  }
  const double pixels = static_cast<double>(window.n) * window.n / 4;
  for (double& sum : sums) sum /= pixels;
  return sums;
}

}  // namespace fathom
