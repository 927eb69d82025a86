// SPDX-License-Identifier: Apache-2.0
// Sums over the cells of a part of a map, and the plane that fits it best.
#pragma once

#include <array>

#include "depth/surfaces.hpp"

namespace fathom::depth {

/// A plane of positions, with how sure it is by the noise of its cells.
struct PartPlane {
  double x = 0, y = 0;              ///< The middle of what it was fitted to, px.
  double position = 0;              ///< There, in the lens's unit.
  double sigma = 0;                 ///< Of that, by noise alone.
  double slope_x = 0, slope_y = 0;  ///< For each pixel to the right, and down.
  double slope_sigma_x = 0, slope_sigma_y = 0;
};

class Moments {
 public:
  void add_area(double x, double y, double pixels, double texture);
  /// A cell that is no rim, x and y px.
  void add_position(double x, double y, double position, double noise, double weight);
  Moments& operator+=(const Moments& other);

  /// Of what has a position.
  bool empty() const { return !(normal_[0][0] > 0); }
  double weight() const { return normal_[0][0]; }

  /// reach_px: from here on places have noise of their own.
  PartPlane plane(double reach_px) const;
  /// Fills all of a surface but its box and its parts. texture: of the picture.
  void write(SeenSurface& surface, double shared_sigma, double reach_px, double texture) const;

 private:
  /// Of the least squares' plane, about its middle.
  struct Central {
    double x, y, xx, xy, yy, xz, yz;
  };
  Central central() const;
  double noise(double reach_px) const;

  double area_ = 0, x_ = 0, y_ = 0, texture_ = 0, square_ = 0, variance_ = 0;
  std::array<std::array<double, 3>, 3> normal_{};
  std::array<double, 3> right_{};
};

}  // namespace fathom::depth
