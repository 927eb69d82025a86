// SPDX-License-Identifier: Apache-2.0
// What stands before the camera: layers of cut-out cards, drawn in millimetres on the object.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace fathom::simulated {

inline constexpr int kWidthPx = 256;  ///< The thesis' picture (T1).
inline constexpr int kHeightPx = 240;
inline constexpr int kFieldPx =
    256;  ///< The square field that is computed; the picture is its middle.
inline constexpr int kCellsPerPx =
    2;  ///< Scenes are drawn this much finer, so that aliasing is honest.
inline constexpr int kFieldCells = kFieldPx * kCellsPerPx;

/// Reflectance of the grey card behind every object.
inline constexpr double kGreyCard = 0.18;

enum class Target {
  usaf,      ///< USAF-1951 resolution chart.
  seedling,  ///< Pine seedling: a stem, and needles that stand in front of it.
  orange,    ///< Sphere with faint dimples.
  blank,     ///< The grey card alone.
  slant,     ///< Textured plane at a slant (relief.hpp).
  stair,     ///< Textured bands, each nearer than the one on its left (relief.hpp).
  sphere,    ///< Textured ball before a plane (relief.hpp).
};

/// Names of the targets, in their order.
inline constexpr std::string_view kTargetNames[] = {"usaf",  "seedling", "orange", "blank",
                                                    "slant", "stair",    "sphere"};

/// A card parallel to the sensor. Every cell holds the mean over its area of the reflectance times
/// the covered part (real) and of the covered part (imaginary): what both are blurred as one.
class Layer {
 public:
  /// in_front_mm: how much nearer it is than the target. cell_mm: side of one cell on the object.
  Layer(double in_front_mm, double cell_mm)
      : in_front_mm_(in_front_mm),
        cell_mm_(cell_mm),
        cells_(std::size_t{kFieldCells} * kFieldCells) {}

  double in_front_mm() const { return in_front_mm_; }
  double cell_mm() const { return cell_mm_; }
  /// [row][col], kFieldCells squared.
  std::span<const std::complex<float>> cells() const { return cells_; }

  /// Covers the whole card.
  void fill(double reflectance);

  /// Paints an upright rectangle given in mm from the centre, exact to its area in every cell.
  void paint_rectangle(double left_mm, double top_mm, double width_mm, double height_mm,
                       double reflectance);

  /// Paints over part of every cell in a box. shape(x_mm, y_mm) gives the signed distance to the
  /// edge in mm, negative inside; shade(x_mm, y_mm) the reflectance.
  template <class Shape, class Shade>
  void paint(double left_mm, double top_mm, double right_mm, double bottom_mm, Shape shape,
             Shade shade);

 private:
  /// First cell whose centre is not left of (or above) a place, within the field.
  int first_cell(double place_mm) const;
  double centre_mm(int cell) const { return (cell - kFieldCells / 2.0 + 0.5) * cell_mm_; }
  void cover(int row, int col, double part, double reflectance);

  double in_front_mm_;
  double cell_mm_;
  std::vector<std::complex<float>> cells_;
};

/// Layers before a uniform grey card, the farthest first.
struct Scene {
  std::vector<Layer> layers;
};

/// Draws a target at a distance: of those of relief.hpp nothing. Its details follow from the seed alone, so it is the same object
/// at every distance.
Scene draw_scene(Target target, double distance_mm, std::uint64_t seed);

/// The same where a pixel is so wide on the object, mm.
Scene draw_scene_at(Target target, double pixel_mm, std::uint64_t seed);

// One per target, each in its own file.
void draw_usaf(Scene& scene, double cell_mm);
void draw_seedling(Scene& scene, double cell_mm, std::uint64_t seed);
void draw_orange(Scene& scene, double cell_mm, std::uint64_t seed);

template <class Shape, class Shade>
void Layer::paint(double left_mm, double top_mm, double right_mm, double bottom_mm, Shape shape,
                  Shade shade) {
  const int first_row = first_cell(top_mm - cell_mm_), last_row = first_cell(bottom_mm + cell_mm_);
  const int first_col = first_cell(left_mm - cell_mm_), last_col = first_cell(right_mm + cell_mm_);
  for (int row = first_row; row < last_row; ++row) {
    for (int col = first_col; col < last_col; ++col) {
      const double x = centre_mm(col), y = centre_mm(row);
      // An edge that passes a cell's centre at s cells covers 1/2 - s of it, to within a few per
      // cent.
      const double part = 0.5 - shape(x, y) / cell_mm_;
      if (part > 0) cover(row, col, part < 1 ? part : 1, shade(x, y));
    }
  }
}

}  // namespace fathom::simulated
