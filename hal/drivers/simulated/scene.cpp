// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/scene.hpp"

#include <algorithm>
#include <cmath>

#include "hal/drivers/simulated/thin_lens.hpp"

namespace fathom::simulated {

void Layer::fill(double reflectance) {
  std::fill(cells_.begin(), cells_.end(), std::complex<float>(static_cast<float>(reflectance), 1));
}

int Layer::first_cell(double place_mm) const {
  const double cell = std::ceil(place_mm / cell_mm_ - 0.5) + kFieldCells / 2.0;
  return static_cast<int>(std::clamp(cell, 0.0, double{kFieldCells}));
}

void Layer::cover(int row, int col, double part, double reflectance) {
  std::complex<float>& cell = cells_[static_cast<std::size_t>(row) * kFieldCells + col];
  const std::complex<float> paint(static_cast<float>(reflectance), 1);
  cell += static_cast<float>(part) * (paint - cell);
}

void Layer::paint_rectangle(double left_mm, double top_mm, double width_mm, double height_mm,
                            double reflectance) {
  const auto overlap = [&](int cell, double from_mm, double length_mm) {
    const double begin = centre_mm(cell) - cell_mm_ / 2;
    const double shared =
        std::min(begin + cell_mm_, from_mm + length_mm) - std::max(begin, from_mm);
    return std::max(shared, 0.0) / cell_mm_;
  };
  const int last_row = first_cell(top_mm + height_mm + cell_mm_);
  const int last_col = first_cell(left_mm + width_mm + cell_mm_);
  for (int row = first_cell(top_mm - cell_mm_); row < last_row; ++row) {
    const double vertical = overlap(row, top_mm, height_mm);
    for (int col = first_cell(left_mm - cell_mm_); vertical > 0 && col < last_col; ++col) {
      cover(row, col, vertical * overlap(col, left_mm, width_mm), reflectance);
    }
  }
}

Scene draw_scene(Target target, double distance_mm, std::uint64_t seed) {
  return draw_scene_at(target, kPitchMm / magnification(distance_mm), seed);
}

Scene draw_scene_at(Target target, double pixel_mm, std::uint64_t seed) {
  const double cell_mm = pixel_mm / kCellsPerPx;
  Scene scene;
  switch (target) {
    case Target::usaf:
      draw_usaf(scene, cell_mm);
      break;
    case Target::seedling:
      draw_seedling(scene, cell_mm, seed);
      break;
    case Target::orange:
      draw_orange(scene, cell_mm, seed);
      break;
    case Target::blank:
    case Target::slant:
    case Target::stair:
    case Target::sphere:
      break;
  }
  return scene;
}

}  // namespace fathom::simulated
