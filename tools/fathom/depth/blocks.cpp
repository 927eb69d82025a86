// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/depth/blocks.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::cli {

using namespace mapping;

namespace {

/// The mean depth of a block, of some of its pixels; NaN where half of them have none.
double mean_of(const DepthMaps& maps, int left, int top, int right, int bottom) {
  constexpr int kLooks = 16;
  double sum = 0;
  int known = 0, all = 0;
  for (int y = top; y < bottom; y += std::max(1, (bottom - top) / kLooks)) {
    for (int x = left; x < right; x += std::max(1, (right - left) / kLooks), ++all) {
      const float depth = maps.position[std::size_t{1} * y * maps.width_px + x];
      if (std::isnan(depth)) continue;
      sum += depth;
      ++known;
    }
  }
  return 2 * known > all ? sum / known : std::nan("");
}

char digit_of(double depth, double low, double high) {
  if (std::isnan(depth)) return '.';
  const double part = high > low ? (depth - low) / (high - low) : 0;
  return static_cast<char>('0' + std::clamp(static_cast<int>(10 * part), 0, 9));
}

}  // namespace

std::vector<std::string> depth_blocks(const DepthMaps& maps, double low, double high, int columns) {
  columns = std::clamp(columns, 1, maps.width_px);
  const double side = static_cast<double>(maps.width_px) / columns;
  const int rows = std::max(1, static_cast<int>(std::lround(maps.height_px / (2 * side))));
  std::vector<std::string> lines;
  for (int row = 0; row < rows; ++row) {
    std::string line;
    const auto edge = [](int i, int of, int size) {
      return static_cast<int>(std::int64_t{i} * size / of);
    };
    for (int column = 0; column < columns; ++column) {
      line += digit_of(
          mean_of(maps, edge(column, columns, maps.width_px), edge(row, rows, maps.height_px),
                  edge(column + 1, columns, maps.width_px), edge(row + 1, rows, maps.height_px)),
          low, high);
    }
    lines.push_back(line);
  }
  return lines;
}

}  // namespace fathom::cli
