// SPDX-License-Identifier: Apache-2.0
#include "depth/surfaces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "depth/cells.hpp"
#include "depth/joining.hpp"
#include "depth/moments.hpp"
#include "engine/error.hpp"
#include "engine/quantile.hpp"

namespace fathom {

using namespace depth;

namespace {

constexpr int kNone = Surfaces::kNone;

/// Parts of a map: first the connected ones of what is sure, then what lies around them.
class Parts {
 public:
  Parts(const Cells& cells, const DepthMaps& maps) : cells_(cells), shared_(maps.shared_sigma) {
    const std::vector<char> jumps = jumps_of(cells, maps);
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
      if (cells.is_known(cell) && !jumps[cell]) smooth_[cell] = 1;
    }
    open();
    owner_.assign(cells.size(), kNone);
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
      if (core_[cell] && owner_[cell] == kNone) flood(cell);
    }
    numbers_ = joined_parts(cells, maps, owner_, jumps, moments());
  }

  /// Whether a cell is no rim of its part.
  bool is_core(std::size_t cell) const { return core_[cell] != 0; }
  /// Pixels of each part, without its rim.
  const std::vector<std::size_t>& areas() const { return areas_; }
  /// Of each part the number of the one that it is a piece of, itself or another.
  const std::vector<int>& pieces_of() const { return numbers_; }
  const std::vector<int>& owner() const { return owner_; }

  /// Gives the parts, those that are pieces of others too, new numbers, kNone for those to be
  /// dropped; then each takes the known cells around it, the nearest part each.
  void renumber(const std::vector<int>& numbers) {
    for (int& owner : owner_) {
      if (owner == kNone) continue;
      const auto whole = static_cast<std::size_t>(numbers_[static_cast<std::size_t>(owner)]);
      owner = numbers[whole] == kNone ? kDropped : numbers[whole];
    }
    grow();
    std::ranges::replace(owner_, kDropped, kNone);
  }

 private:
  /// A small part is another surface: nobody takes its cells.
  static constexpr int kDropped = -2;

  template <class Take>
  void each_neighbour(std::size_t cell, const Take& take) const {
    const auto column = static_cast<int>(cell % cells_.columns);
    const auto row = static_cast<int>(cell / cells_.columns);
    if (column > 0) take(cell - 1);
    if (column + 1 < cells_.columns) take(cell + 1);
    if (row > 0) take(cell - cells_.columns);
    if (row + 1 < cells_.rows) take(cell + cells_.columns);
  }

  std::vector<Moments> moments() const {
    std::vector<Moments> all(areas_.size());
    for (std::size_t cell = 0; cell < owner_.size(); ++cell) {
      if (owner_[cell] == kNone) continue;
      const auto columns = static_cast<std::size_t>(cells_.columns);
      const double x = (static_cast<double>(cell % columns) + 0.5) * cells_.side_px;
      const double y = (static_cast<double>(cell / columns) + 0.5) * cells_.side_px;
      all[static_cast<std::size_t>(owner_[cell])].add_position(
          x, y, cells_.position[cell], cells_.noise[cell], cells_.known_px[cell]);
    }
    return all;
  }

  /// Takes away what is only one or two cells wide. A hole of one cell takes nothing away.
  void open() {
    constexpr int kMostMissing = 2;
    for (int row = 0; row < cells_.rows; ++row) {
      for (int column = 0; column < cells_.columns; ++column) {
        const std::size_t cell = cells_.at(column, row);
        core_[cell] = smooth_[cell] && missing_around(column, row) <= kMostMissing;
      }
    }
  }

  int missing_around(int column, int row) const {
    int missing = 0;
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, cells_.rows - 1); ++y) {
      for (int x = std::max(column - 1, 0); x <= std::min(column + 1, cells_.columns - 1); ++x)
        missing += !smooth_[cells_.at(x, y)];
    }
    return missing;
  }

  void flood(std::size_t first) {
    const auto number = static_cast<int>(areas_.size());
    std::size_t area = 0;
    std::vector<std::size_t> waiting{first};
    owner_[first] = number;
    while (!waiting.empty()) {
      const std::size_t cell = waiting.back();
      waiting.pop_back();
      area += static_cast<std::size_t>(cells_.known_px[cell]);
      each_neighbour(cell, [&](std::size_t next) {
        if (!core_[next] || owner_[next] != kNone || !agree(cell, next)) return;
        owner_[next] = number;
        waiting.push_back(next);
      });
    }
    areas_.push_back(area);
  }

  /// Whether a step from one cell to its neighbour is none that noise and twice the slope around
  /// it do not explain.
  bool agree(std::size_t a, std::size_t b) const {
    constexpr float kSigmas = 3, kSlopes = 2;
    const float step = std::abs(cells_.position[a] - cells_.position[b]);
    const float noise = std::hypot(cells_.noise[a], cells_.noise[b]);
    return step <= std::hypot(kSigmas * noise, shared_) + kSlopes * slope_around(a, b);
  }

  /// For each cell, over as many as windows smear a cliff, less where a part ends before; 0 where
  /// too few are known.
  float slope_around(std::size_t a, std::size_t b) const {
    constexpr int kFewest = kReachCells + 1;
    std::size_t low = std::min(a, b), high = std::max(a, b);
    const std::size_t stride = high - low;
    const bool is_across = stride == 1;
    const auto place = static_cast<int>(is_across ? low % cells_.columns : low / cells_.columns);
    const int length = is_across ? cells_.columns : cells_.rows;
    int steps = 1;
    for (int i = 1; i <= kReachCells; ++i) {
      if (place + 1 + i < length && cells_.is_known(high + stride)) high += stride, ++steps;
      if (place - i >= 0 && cells_.is_known(low - stride)) low -= stride, ++steps;
    }
    if (steps < kFewest) return 0;
    return std::abs(cells_.position[high] - cells_.position[low]) / static_cast<float>(steps);
  }

  void grow() {
    constexpr int kRings = 2 * kReachCells + 1;  // of cells: half a cliff, and the opening's rim
    std::vector<std::size_t> rim, next_rim;
    for (std::size_t cell = 0; cell < owner_.size(); ++cell) {
      if (owner_[cell] >= 0) rim.push_back(cell);
    }
    for (int ring = 0; ring < kRings; ++ring, rim.swap(next_rim)) {
      next_rim.clear();
      for (const std::size_t cell : rim) {
        each_neighbour(cell, [&](std::size_t next) {
          if (owner_[next] != kNone || !cells_.is_known(next)) return;
          owner_[next] = owner_[cell];
          core_[next] = 0;
          next_rim.push_back(next);
        });
      }
    }
  }

  const Cells& cells_;
  float shared_;
  std::vector<char> smooth_ = std::vector<char>(cells_.size());
  std::vector<char> core_ = std::vector<char>(cells_.size());
  std::vector<int> owner_;
  std::vector<std::size_t> areas_;
  std::vector<int> numbers_;
};

/// Of each part its pixels with those of its pieces; 0 for a piece.
std::vector<std::size_t> whole_areas(const Parts& parts) {
  std::vector<std::size_t> areas(parts.areas().size());
  for (std::size_t part = 0; part < areas.size(); ++part)
    areas[static_cast<std::size_t>(parts.pieces_of()[part])] += parts.areas()[part];
  return areas;
}

/// How many pieces that are worth telling by themselves each surface has.
void count_pieces(const Parts& parts, const std::vector<int>& numbers, double least,
                  std::vector<SeenSurface>& found) {
  for (SeenSurface& surface : found) surface.pieces = 0;
  for (std::size_t part = 0; part < parts.areas().size(); ++part) {
    const int number = numbers[static_cast<std::size_t>(parts.pieces_of()[part])];
    if (number != kNone && static_cast<double>(parts.areas()[part]) >= least)
      ++found[static_cast<std::size_t>(number)].pieces;
  }
  for (SeenSurface& surface : found) surface.pieces = std::max(surface.pieces, 1);
}

/// Numbers of the parts that are large enough, by area; kNone for the others.
std::vector<int> ranked(const std::vector<std::size_t>& areas, double least) {
  std::vector<std::size_t> order(areas.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return areas[a] > areas[b]; });
  std::vector<int> numbers(areas.size(), kNone);
  int next = 0;
  for (const std::size_t part : order) {
    if (static_cast<double>(areas[part]) >= least) numbers[part] = next++;
  }
  return numbers;
}

/// Grows a box by a cell.
void include(PixelBox& box, int left, int top, int right, int bottom) {
  if (box.width_px == 0) {
    box = {left, top, right - left, bottom - top};
    return;
  }
  const int x = std::min(box.x, left), y = std::min(box.y, top);
  box = {x, y, std::max(box.x + box.width_px, right) - x,
         std::max(box.y + box.height_px, bottom) - y};
}

void measure(const Cells& cells, const Parts& parts, const DepthMaps& maps, Surfaces& surfaces) {
  std::vector<Moments> moments(surfaces.found.size());
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    const int owner = surfaces.owner[cell];
    if (owner == kNone) continue;
    const int left = static_cast<int>(cell % cells.columns) * cells.side_px;
    const int top = static_cast<int>(cell / cells.columns) * cells.side_px;
    const int right = std::min(left + cells.side_px, maps.width_px);
    const int bottom = std::min(top + cells.side_px, maps.height_px);
    const double x = (left + right - 1) / 2.0, y = (top + bottom - 1) / 2.0;
    const double pixels = cells.known_px[cell];
    Moments& own = moments[static_cast<std::size_t>(owner)];
    include(surfaces.found[static_cast<std::size_t>(owner)].box, left, top, right, bottom);
    own.add_area(x, y, pixels, cells.texture[cell]);
    if (parts.is_core(cell))
      own.add_position(x, y, cells.position[cell], cells.noise[cell], pixels);
  }
  const double texture = std::accumulate(cells.texture.begin(), cells.texture.end(), 0.0);
  for (std::size_t i = 0; i < moments.size(); ++i)
    moments[i].write(surfaces.found[i], maps.shared_sigma, maps.reach_px, texture);
}

double usual_sigma(const Cells& cells, double shared) {
  std::vector<float> noises;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    if (cells.is_known(cell)) noises.push_back(cells.noise[cell]);
  }
  if (noises.empty()) return shared;
  return std::hypot(median(std::move(noises)), shared);
}

/// A part is worth telling from this part of the picture on, and where it is more than one place.
double least_area(const DepthMaps& maps) {
  constexpr double kPart = 0.002;
  return std::max(1.0 * maps.reach_px * maps.reach_px, kPart * maps.width_px * maps.height_px);
}

}  // namespace

Surfaces find_surfaces(const DepthMaps& maps, const Frame* sharp) {
  if (sharp && (sharp->width_px() != maps.width_px || sharp->height_px() != maps.height_px)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("the sharp picture is {} x {} px, the map {} x {}", sharp->width_px(),
                            sharp->height_px(), maps.width_px, maps.height_px));
  }
  Cells cells = cells_of(maps, sharp);
  Parts parts(cells, maps);
  const double least = least_area(maps);
  const std::vector<std::size_t> areas = whole_areas(parts);
  const std::vector<int> numbers = ranked(areas, least);
  const auto wholes = areas.size() - static_cast<std::size_t>(std::ranges::count(areas, 0u));
  const auto large = numbers.size() - static_cast<std::size_t>(std::ranges::count(numbers, kNone));
  parts.renumber(numbers);
  Surfaces surfaces{.found = std::vector<SeenSurface>(large),
                    .small = wholes - large,
                    .owner = parts.owner(),
                    .side_px = cells.side_px,
                    .columns = cells.columns,
                    .rows = cells.rows,
                    .width_px = maps.width_px,
                    .height_px = maps.height_px,
                    .usual_sigma = usual_sigma(cells, maps.shared_sigma)};
  measure(cells, parts, maps, surfaces);
  count_pieces(parts, numbers, least, surfaces.found);
  surfaces.texture = std::move(cells.texture);
  surfaces.position = std::move(cells.position);
  return surfaces;
}

}  // namespace fathom
