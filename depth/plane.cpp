// SPDX-License-Identifier: Apache-2.0
#include "depth/plane.hpp"

#include <algorithm>
#include <cstdint>

namespace fathom::depth {
namespace {

/// Of pixel 4 i + 2 + k between the middles of cells i and i + 1.
constexpr float kPhases[kCell] = {0.125F, 0.375F, 0.625F, 0.875F};

}  // namespace

Plane pooled(const Plane& plane) {
  Plane result(cells(plane.width), cells(plane.height));
  for (int y = 0; y < result.height; ++y) {
    const int rows = std::min(kCell, plane.height - y * kCell);
    float* const to = result.row(y);
    for (int r = 0; r < rows; ++r) {
      const float* const from = plane.row(y * kCell + r);
      for (int x = 0; x < plane.width; ++x) to[x / kCell] += from[x];
    }
    for (int x = 0; x < result.width; ++x)
      to[x] /= static_cast<float>(rows * std::min(kCell, plane.width - x * kCell));
  }
  return result;
}

Plane smoothed(const Plane& plane) {
  const int w = plane.width, h = plane.height;
  Plane across(w, h), result(w, h);
  for (int y = 0; y < h; ++y) {
    const float* const from = plane.row(y);
    float* const to = across.row(y);
    for (int x = 0; x < w; ++x)
      to[x] = 0.25F * (from[std::max(x - 1, 0)] + 2 * from[x] + from[std::min(x + 1, w - 1)]);
  }
  for (int y = 0; y < h; ++y) {
    const float *const above = across.row(std::max(y - 1, 0)), *const here = across.row(y),
                       *const below = across.row(std::min(y + 1, h - 1));
    float* const to = result.row(y);
    for (int x = 0; x < w; ++x) to[x] = 0.25F * (above[x] + 2 * here[x] + below[x]);
  }
  return result;
}

void expand_row(const Plane& cells, int y, int width, float* scratch, float* out) {
  const int shifted = y - kCell / 2;
  const int first = shifted >= 0 ? shifted / kCell : -1;
  const float weight = kPhases[shifted - first * kCell];
  const float* const above = cells.row(std::clamp(first, 0, cells.height - 1));
  const float* const below = cells.row(std::clamp(first + 1, 0, cells.height - 1));
  for (int x = 0; x < cells.width; ++x) scratch[x] = above[x] + weight * (below[x] - above[x]);
  for (int x = 0; x < std::min(kCell / 2, width); ++x) out[x] = scratch[0];
  int x = kCell / 2;
  for (int i = 0; x + kCell <= width && i + 1 < cells.width; ++i, x += kCell) {
    const float left = scratch[i], step = scratch[i + 1] - scratch[i];
    for (int k = 0; k < kCell; ++k) out[x + k] = left + kPhases[k] * step;
  }
  for (; x < width; ++x) {
    const int i = (x - kCell / 2) / kCell, next = std::min(i + 1, cells.width - 1);
    out[x] = scratch[i] + kPhases[(x - kCell / 2) % kCell] * (scratch[next] - scratch[i]);
  }
}

Plane difference(const Plane& plane, const Plane& cells) {
  Plane result = plane;
  std::vector<float> scratch(static_cast<std::size_t>(cells.width)),
      expanded(static_cast<std::size_t>(plane.width));
  for (int y = 0; y < plane.height; ++y) {
    expand_row(cells, y, plane.width, scratch.data(), expanded.data());
    float* const row = result.row(y);
    for (int x = 0; x < plane.width; ++x) row[x] -= expanded[static_cast<std::size_t>(x)];
  }
  return result;
}

std::vector<float> means_of_parts(const Plane& plane, int columns, int rows) {
  std::vector<float> sums(std::size_t{1} * columns * rows), counts(sums.size());
  for (int y = 0; y < plane.height; ++y) {
    const auto first = static_cast<std::size_t>(std::int64_t{y} * rows / plane.height) * columns;
    for (int x = 0; x < plane.width; ++x) {
      const auto at = first + static_cast<std::size_t>(std::int64_t{x} * columns / plane.width);
      sums[at] += plane.row(y)[x];
      counts[at] += 1;
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= std::max(counts[i], 1.0F);
  return sums;
}

}  // namespace fathom::depth
