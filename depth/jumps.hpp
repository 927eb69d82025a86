// SPDX-License-Identifier: Apache-2.0
// Where a surface jumps: by more than its own slopes on both sides explain.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <vector>

namespace fathom::depth {

/// Places of a surface, row by row, NaN where none is known, and their noise.
struct PlaceGrid {
  int columns = 0;
  int rows = 0;
  std::span<const float> place;
  std::span<const float> noise;
};

enum class Axis { along_rows, along_columns };

/// The jumps along one axis. Of each place: 0 where there can be none.
struct Jumps {
  std::vector<float> height;  ///< What the slopes on both sides leave of the rise.
  std::vector<float> rise;
  std::vector<float> sigma;  ///< Of the height, by what the places say of their noise.

  /// Whether a place has a jump that is more than noise, such a part of its sigma, and what all places
  /// share.
  bool is_one(std::size_t place, float noise, float shared_sigma) const;
};

/// Those over each of some distances to each side. Places are averaged across the axis first.
std::vector<Jumps> jumps_along(const PlaceGrid& grid, Axis axis,
                               std::initializer_list<int> reaches);

/// How much of the noise that the places admit is seen where nothing jumps: a part of 1 at most.
float seen_noise(const Jumps& jumps);

}  // namespace fathom::depth
