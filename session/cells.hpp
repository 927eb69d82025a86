// SPDX-License-Identifier: Apache-2.0
// A picture in a few numbers, to see later whether the lens stands where it stood.
#pragma once

#include <cstdint>
#include <vector>

#include "../engine/frame.hpp"
#include "../engine/window.hpp"

namespace fathom {

/// PictureFacts::cells: sums of the grey values of squares of kCellPx a side, row by row: as many as
/// the picture has room for, kCellsAcross each way at most, round the middle of the window.
std::vector<std::uint32_t> cells_round(const Frame& frame, const Window& window);

inline constexpr int kCellPx = 16, kCellsAcross = 16;

}  // namespace fathom
