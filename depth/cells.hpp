// SPDX-License-Identifier: Apache-2.0
// A map of depth in cells of some pixels, and where the surface jumps from one cell to the next.
#pragma once

#include <cstddef>
#include <vector>

#include "depth/maps.hpp"
#include "engine/frame.hpp"

namespace fathom::depth {

/// Row by row, columns * rows each. Cells over the right and the lower edge hold what there is.
struct Cells {
  int side_px = 0;
  int columns = 0;
  int rows = 0;
  std::vector<float> position =
      {};  ///< Mean of what is known; NaN where less than half of the cell is.
  std::vector<float> noise = {};  ///< Sigma of the position, without what all places share.
  std::vector<float> texture =
      {};  ///< Squared differences of neighbouring pixels; 0 without a picture.
  std::vector<int> known_px = {};  ///< Pixels whose depth was measured.

  std::size_t size() const { return position.size(); }
  std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(row) * columns + column;
  }
  bool is_known(std::size_t cell) const { return position[cell] == position[cell]; }
};

/// How far from a cell the surface is looked at for a jump, cells: half of what windows smear.
inline constexpr int kReachCells = 2;

/// sharp: null, or a picture of the map's size.
Cells cells_of(const DepthMaps& maps, const Frame* sharp);

/// 1 for cells where the surface jumps by more than it may: than its own slopes on both sides,
/// noise and shared_sigma explain.
std::vector<char> jumps_of(const Cells& cells, const DepthMaps& maps);

}  // namespace fathom::depth
