// SPDX-License-Identifier: Apache-2.0
#include "session/cells.hpp"

#include <algorithm>
#include <cstddef>

namespace fathom {
namespace {

/// Cells along an axis of this length, and where the first begins.
struct Span {
  int cells = 0;
  int start = 0;
};

Span span_round(int middle, int length) {
  const int cells = std::min(kCellsAcross, length / kCellPx);
  const int wide = cells * kCellPx;
  return {cells, std::clamp(middle - wide / 2, 0, length - wide)};
}

}  // namespace

std::vector<std::uint32_t> cells_round(const Frame& frame, const Window& window) {
  const Span across = span_round(window.x + window.n / 2, frame.width_px());
  const Span down = span_round(window.y + window.n / 2, frame.height_px());
  std::vector<std::uint32_t> cells(static_cast<std::size_t>(across.cells * down.cells));
  for (int y = 0; y < down.cells * kCellPx; ++y) {
    std::uint32_t* const row = cells.data() + y / kCellPx * across.cells;
    for (int x = 0; x < across.cells * kCellPx; ++x)
      row[x / kCellPx] += frame.at(across.start + x, down.start + y);
  }
  return cells;
}

}  // namespace fathom
