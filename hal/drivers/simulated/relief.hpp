// SPDX-License-Identifier: Apache-2.0
// Targets whose depth is known at every pixel: textured sheets, nearer ones before farther ones.
//
// Every point of a sheet becomes the disc that the thin lens makes of its own distance. A sheet goes
// on behind the nearer ones, so their blurred edges let it through, as on a real object.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/drivers/simulated/scene.hpp"
#include "hal/drivers/simulated/texture.hpp"

namespace fathom::simulated {

/// The middle of the picture, px: a pixel's place is that of its centre.
inline constexpr double kMiddleXPx = (kWidthPx - 1) / 2.0;
inline constexpr double kMiddleYPx = (kHeightPx - 1) / 2.0;

/// The shapes of the relief targets. All are about the target's distance D; x and y are pixels.
struct ReliefShape {
  double slope_mm = 0.5;  ///< Target::slant: D + slope (x - kMiddleXPx).
  double step_mm = 30;  ///< Target::stair: bands of equal width, each so much nearer to the right.
  int steps = 4;        ///< Of the stair: D + step ((steps - 1)/2 - band), band from 0.
  /// Target::sphere: its nearest point is at D, in the middle. Behind it stands a plane, one
  /// diameter farther.
  double radius_mm = 39;
  /// Whether the picture grows with the image's distance, as a thin lens has it. Its size is right,
  /// and x and y mean what they say, with the lens focused at D.
  bool breathes = false;

  bool operator==(const ReliefShape&) const = default;
};

/// Whether a target is one of those of this file.
bool is_relief(Target target);

class Relief {
 public:
  /// target: for which is_relief() holds. Its texture follows from the seed alone.
  Relief(Target target, const ReliefShape& shape, double distance_mm, std::uint64_t seed);

  /// Distance of what a place in the picture shows, mm.
  double distance_mm(double x_px, double y_px) const;

  /// Mean reflectance that each pixel sees, [row][col] of kHeightPx x kWidthPx.
  std::vector<float> picture(int lens_steps, double f_number) const;

 private:
  class Sheet;

  int sheet_count() const { return static_cast<int>(textures_.size()); }
  Sheet sheet(int number) const;
  double growth(int lens_steps) const;

  Target target_;
  ReliefShape shape_;
  double distance_mm_;
  double mm_per_px_;               ///< On the object.
  std::vector<Texture> textures_;  ///< One a sheet.
};

}  // namespace fathom::simulated
