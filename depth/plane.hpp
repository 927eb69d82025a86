// SPDX-License-Identifier: Apache-2.0
// A picture of floats that is a power of four smaller than another one, and the way back.
#pragma once

#include <cstddef>
#include <vector>

namespace fathom::depth {

/// How many pixels of one side a cell of the next plane holds.
inline constexpr int kCell = 4;

constexpr int cells(int pixels) { return (pixels + kCell - 1) / kCell; }

struct Plane {
  int width = 0;
  int height = 0;
  std::vector<float> values;

  Plane() = default;
  Plane(int plane_width, int plane_height, float value = 0)
      : width(plane_width),
        height(plane_height),
        values(static_cast<std::size_t>(plane_width) * static_cast<std::size_t>(plane_height),
               value) {}

  float* row(int y) { return values.data() + static_cast<std::size_t>(y) * width; }
  const float* row(int y) const { return values.data() + static_cast<std::size_t>(y) * width; }
};

/// The mean of each cell of the plane; cells over the edge hold what there is.
Plane pooled(const Plane& plane);

/// Weighed means of a cell with its neighbours, 1:2:1 in each direction; edges repeat.
Plane smoothed(const Plane& plane);

/// The plane less what its cells say of it (expand_row).
Plane difference(const Plane& plane, const Plane& cells);

/// The means of columns x rows equal parts of the plane, row by row.
std::vector<float> means_of_parts(const Plane& plane, int columns, int rows);

/// Row y of the plane that has kCell times as many rows and columns (up to `width`), bilinear
/// between the middles of cells; edges repeat. out: width floats. scratch: cells.width floats.
void expand_row(const Plane& cells, int y, int width, float* scratch, float* out);

}  // namespace fathom::depth
