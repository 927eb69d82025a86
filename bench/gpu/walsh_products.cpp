// SPDX-License-Identifier: Apache-2.0
#include "walsh_products.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <limits>

namespace fathom::bench {
namespace {

using Bytes = std::array<std::int8_t, kPixels>;
using Words = std::array<std::int32_t, kPixels>;

constexpr int kTileRows = 16, kTileColumns = 8, kTileDepth = 32;
/// A limb is worth so many of the next lower one.
constexpr int kLimb = 128;

constexpr std::size_t at(int row, int column) {
  return static_cast<std::size_t>(row) * kSide + column;
}

int sign_changes(const std::array<std::int8_t, kSide>& row) {
  int count = 0;
  for (int x = 1; x < kSide; ++x) count += row[x] != row[x - 1];
  return count;
}

/// Sylvester's rows by their number of sign changes, which are 0 to 63, each once.
Bytes sequency_matrix() {
  Bytes matrix{};
  for (unsigned k = 0; k < kSide; ++k) {
    std::array<std::int8_t, kSide> row{};
    for (unsigned x = 0; x < kSide; ++x) row[x] = std::popcount(k & x) % 2 == 0 ? 1 : -1;
    std::copy(row.begin(), row.end(), matrix.begin() + at(sign_changes(row), 0));
  }
  return matrix;
}

Bytes transposed(const Bytes& matrix) {
  Bytes result{};
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) result[at(j, i)] = matrix[at(i, j)];
  }
  return result;
}

std::int32_t checked_sum(std::int64_t sum) {
  if (sum < std::numeric_limits<std::int32_t>::min() ||
      sum > std::numeric_limits<std::int32_t>::max()) {
    throw std::overflow_error("a sum of products does not fit 32 bits");
  }
  return static_cast<std::int32_t>(sum);
}

std::int8_t checked_limb(std::int32_t value) {
  if (value < -128 || value > 127) throw std::overflow_error("a limb does not fit 8 bits");
  return static_cast<std::int8_t>(value);
}

/// value = kLimb high + low, both of 8 bits: low is rounded to nearest, so high needs no ninth.
void split(const Words& values, Bytes& high, Bytes& low) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::int32_t upper = (values[i] + kLimb / 2) >> 7;
    high[i] = checked_limb(upper);
    low[i] = checked_limb(values[i] - kLimb * upper);
  }
}

/// By rows and by columns: their sums of magnitudes fit 32 bits, the weighted ones do not.
std::int64_t moment_of(const Words& coefficients) {
  std::array<std::int32_t, kSide> rows{}, columns{};
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const std::int32_t mass = std::abs(coefficients[at(i, j)]);
      rows[i] = checked_sum(std::int64_t{rows[i]} + mass);
      columns[j] = checked_sum(std::int64_t{columns[j]} + mass);
    }
  }
  std::int64_t moment = 0;
  for (int i = 0; i < kSide; ++i) moment += std::int64_t{i} * i * (rows[i] + columns[i]);
  return moment;
}

}  // namespace

void TileProducts::add(std::span<const std::int8_t, kPixels> left,
                       std::span<const std::int8_t, kPixels> right,
                       std::span<std::int32_t, kPixels> sums) {
  const auto tile = [&](int row, int column, int depth) {
    for (int i = row; i < row + kTileRows; ++i) {
      for (int j = column; j < column + kTileColumns; ++j) {
        std::int64_t sum = sums[at(i, j)];
        for (int k = depth; k < depth + kTileDepth; ++k) sum += left[at(i, k)] * right[at(k, j)];
        sums[at(i, j)] = checked_sum(sum);
      }
    }
    ++counts_.instructions;
    counts_.products += std::int64_t{kTileRows} * kTileColumns * kTileDepth;
  };
  for (int row = 0; row < kSide; row += kTileRows) {
    for (int column = 0; column < kSide; column += kTileColumns) {
      for (int depth = 0; depth < kSide; depth += kTileDepth) tile(row, column, depth);
    }
  }
}

std::int64_t walsh_sum(std::span<const std::uint8_t, kPixels> pixels, TileProducts& tiles) {
  static const Bytes matrix = sequency_matrix();
  static const Bytes turned = transposed(matrix);
  // 128 less everywhere makes them signed, and changes T(0,0) alone, which has no lever arm.
  Bytes grey{};
  std::transform(pixels.begin(), pixels.end(), grey.begin(),
                 [](std::uint8_t value) { return static_cast<std::int8_t>(value - 128); });
  Words columns{};
  tiles.add(matrix, grey, columns);
  Bytes high{}, low{};
  split(columns, high, low);
  Words coefficients{};
  tiles.add(high, turned, coefficients);
  for (std::int32_t& value : coefficients) value *= kLimb;  // the sums go on from there
  tiles.add(low, turned, coefficients);
  return moment_of(coefficients);
}

}  // namespace fathom::bench
