// SPDX-License-Identifier: Apache-2.0
#include "depth/cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/jumps.hpp"

namespace fathom::depth {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

int side_of(const DepthMaps& maps) {
  constexpr float kInReach = 6;  // Most of a smeared cliff is four cells wide.
  constexpr int kSmallest = 2, kLargest = 16;
  const auto side = static_cast<int>(std::lround(maps.reach_px / kInReach));
  return std::clamp(side, kSmallest, kLargest);
}

/// What one cell comes to.
class CellSum {
 public:
  CellSum(const DepthMaps& maps, const Frame* sharp) : maps_(maps), sharp_(sharp) {}

  void add(int x, int y) {
    const std::size_t pixel = static_cast<std::size_t>(y) * maps_.width_px + x;
    ++all_;
    if (sharp_) texture_ += difference(x, y, x + 1, y) + difference(x, y, x, y + 1);
    if (maps_.classes[pixel] != DepthClass::known) return;
    const float shared = maps_.shared_sigma;
    position_ += maps_.position[pixel];
    variance_ += std::max(maps_.sigma[pixel] * maps_.sigma[pixel] - shared * shared, 0.0f);
    ++known_;
  }

  void write(Cells& cells, std::size_t cell) const {
    const bool is_known = 2 * known_ > all_;
    cells.position[cell] = is_known ? static_cast<float>(position_ / known_) : kUnknown;
    cells.noise[cell] = is_known ? static_cast<float>(std::sqrt(variance_ / known_)) : kUnknown;
    cells.texture[cell] = static_cast<float>(texture_);
    cells.known_px[cell] = known_;
  }

 private:
  double difference(int x, int y, int to_x, int to_y) const {
    if (to_x >= maps_.width_px || to_y >= maps_.height_px) return 0;
    const double off = static_cast<double>(sharp_->at(to_x, to_y)) - sharp_->at(x, y);
    return off * off;
  }

  const DepthMaps& maps_;
  const Frame* sharp_;
  double position_ = 0, variance_ = 0, texture_ = 0;
  int known_ = 0, all_ = 0;
};

}  // namespace

Cells cells_of(const DepthMaps& maps, const Frame* sharp) {
  Cells cells{.side_px = side_of(maps)};
  cells.columns = (maps.width_px + cells.side_px - 1) / cells.side_px;
  cells.rows = (maps.height_px + cells.side_px - 1) / cells.side_px;
  const std::size_t count = static_cast<std::size_t>(cells.columns) * cells.rows;
  cells.position.resize(count);
  cells.noise.resize(count);
  cells.texture.resize(count);
  cells.known_px.resize(count);
  for (int row = 0; row < cells.rows; ++row) {
    const int top = row * cells.side_px, bottom = std::min(top + cells.side_px, maps.height_px);
    for (int column = 0; column < cells.columns; ++column) {
      const int left = column * cells.side_px;
      const int right = std::min(left + cells.side_px, maps.width_px);
      CellSum sum(maps, sharp);
      for (int y = top; y < bottom; ++y) {
        for (int x = left; x < right; ++x) sum.add(x, y);
      }
      sum.write(cells, cells.at(column, row));
    }
  }
  return cells;
}

std::vector<char> jumps_of(const Cells& cells, const DepthMaps& maps) {
  const PlaceGrid grid{cells.columns, cells.rows, cells.position, cells.noise};
  std::vector<char> jumps(cells.size());
  // Cliffs of clear texture are narrow, and those of faint texture wide.
  for (const Axis axis : {Axis::along_rows, Axis::along_columns}) {
    for (const Jumps& found : jumps_along(grid, axis, {kReachCells, 2 * kReachCells})) {
      const float noise = seen_noise(found);
      for (std::size_t cell = 0; cell < jumps.size(); ++cell) {
        if (found.is_one(cell, noise, maps.shared_sigma)) jumps[cell] = 1;
      }
    }
  }
  return jumps;
}

}  // namespace fathom::depth
