// SPDX-License-Identifier: Apache-2.0
#include "depth/cliffs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "depth/jumps.hpp"

namespace fathom::depth {
namespace {

/// Around a node the smallest windows tell enough if those that told are of this many of their sides at
/// most, in the mean. Larger ones see so far that a bend looks like a cliff, and between specks a
/// slope looks like a stair.
constexpr float kSmall = 1.25f;
/// A jump is a cliff where the slopes on both sides leave so much of the rise: of a wave that is 16
/// windows long they leave 0.3.
constexpr float kLeft = 0.45f;
/// In parts of `apart`: what is lower everywhere is no cliff, for places between frames are known less
/// well than those at frames; how low the foot of a cliff is followed; and what is higher the fit of the
/// surface tells from its nodes, more narrowly.
constexpr float kHigh = 0.5f, kFoot = 0.2f, kTall = 4;

/// Places of nodes, and some more around them: beyond an edge a surface goes on as it came.
class Widened {
 public:
  Widened(const Nodes& nodes, int around)
      : columns_(nodes.level.columns + 2 * around),
        rows_(nodes.level.rows + 2 * around),
        around_(around) {
    const std::size_t count = static_cast<std::size_t>(columns_) * rows_;
    places_.reserve(count);
    noises_.reserve(count);
    for (int row = -around; row < nodes.level.rows + around; ++row) {
      for (int column = -around; column < nodes.level.columns + around; ++column)
        add(nodes, column, row);
    }
  }

  PlaceGrid grid() const { return {columns_, rows_, places_, noises_}; }
  std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(row + around_) * columns_ + column + around_;
  }

 private:
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

  static float place_of(const Peak& peak) {
    return peak.kind == DepthClass::known ? peak.place : kUnknown;
  }

  /// Beyond an edge: the place of the mirror's image, on the other side of the edge's own.
  void add(const Nodes& nodes, int column, int row) {
    const auto [edge_x, mirror_x] = mirrored(column, nodes.level.columns);
    const auto [edge_y, mirror_y] = mirrored(row, nodes.level.rows);
    const Peak& edge = nodes.at(edge_x, edge_y);
    const Peak& mirror = nodes.at(mirror_x, mirror_y);
    const bool is_within = edge_x == mirror_x && edge_y == mirror_y;
    places_.push_back(is_within ? place_of(edge) : 2 * place_of(edge) - place_of(mirror));
    noises_.push_back(std::max(edge.sigma, mirror.sigma));
  }

  struct Mirrored {
    int edge, mirror;
  };
  static Mirrored mirrored(int i, int count) {
    const int edge = std::clamp(i, 0, count - 1);
    return {edge, std::clamp(2 * edge - i, 0, count - 1)};
  }

  int columns_, rows_, around_;
  std::vector<float> places_, noises_;
};

/// Of each node the height of its jump, in parts of `apart`; 0 where it has none.
std::vector<float> heights_of(const Nodes& nodes, const Scales& scales, int reach) {
  const Level& level = nodes.level;
  const Widened widened(nodes, 3 * reach);
  std::vector<float> heights(level.nodes());
  for (const Axis axis : {Axis::along_rows, Axis::along_columns}) {
    const Jumps jumps = jumps_along(widened.grid(), axis, {reach}).front();
    const float noise = seen_noise(jumps);
    for (std::size_t node = 0; node < level.nodes(); ++node) {
      const std::size_t place = widened.at(static_cast<int>(node % level.columns),
                                           static_cast<int>(node / level.columns));
      if (!jumps.is_one(place, noise, scales.least_sigma)) continue;
      const float height = std::abs(jumps.height[place]);
      if (height > kLeft * std::abs(jumps.rise[place]))
        heights[node] = std::max(heights[node], height / scales.apart);
    }
  }
  return heights;
}

/// Calls take(number) of the nodes that are no more than `reach` from one along both axes.
template <class Take>
void each_around(const Level& level, std::size_t node, int reach, const Take& take) {
  const int column = static_cast<int>(node % level.columns);
  const int row = static_cast<int>(node / level.columns);
  for (int y = std::max(row - reach, 0); y <= std::min(row + reach, level.rows - 1); ++y) {
    for (int x = std::max(column - reach, 0); x <= std::min(column + reach, level.columns - 1); ++x)
      take(static_cast<std::size_t>(y) * level.columns + x);
  }
}

/// Whether the nodes around one were told by the smallest windows.
bool is_told_by_small(const Nodes& nodes, std::size_t node, int reach) {
  float sum = 0, count = 0;
  each_around(nodes.level, node, 2 * reach, [&](std::size_t other) {
    sum += nodes.peaks[other].side_px;
    ++count;
  });
  return sum <= kSmall * count * static_cast<float>(nodes.level.side_px());
}

}  // namespace

void doubt_cliffs(const Scales& scales, Nodes& nodes) {
  const Level& level = nodes.level;
  const int reach = std::max(static_cast<int>(std::lround(level.side_px() / level.pitch_px())), 1);
  const std::vector<float> heights = heights_of(nodes, scales, reach);
  for (std::size_t node = 0; node < level.nodes(); ++node) {
    Peak& peak = nodes.peaks[node];
    if (peak.kind != DepthClass::known || heights[node] < kFoot) continue;
    float highest = 0;
    each_around(level, node, reach,
                [&](std::size_t other) { highest = std::max(highest, heights[other]); });
    if (highest < kHigh || highest > kTall || !is_told_by_small(nodes, node, reach)) continue;
    peak.kind = DepthClass::two_depths;
  }
}

}  // namespace fathom::depth
