// SPDX-License-Identifier: Apache-2.0
// A texture with details of every size, for targets that have no pattern of their own.
#pragma once

#include <cstdint>
#include <vector>

namespace fathom::simulated {

/// Reflectance about 0.5 at a place on the object: random numbers on lattices of many spacings, with
/// cubic B-splines between them, which look alike wherever a pixel's centre falls.
class Texture {
 public:
  /// which: of the textures of one seed. finest_mm: what is finer is left out, for pixels could not
  /// show it. reach_mm: how far from the middle it is looked at, to either side.
  Texture(std::uint64_t seed, int which, double finest_mm, double reach_mm);
  double at(double x_mm, double y_mm) const;

 private:
  struct Octave {
    Octave(std::uint64_t seed, double spacing, double shift, double reach_mm);
    float at(double x_mm, double y_mm) const;

    double spacing_mm, aside;
    int first = 0, side = 0;    ///< Lattice points from `first` on, in either direction.
    std::vector<float> values;  ///< [row][column], -0.5 to 0.5.
  };

  std::vector<Octave> octaves_;
};

}  // namespace fathom::simulated
