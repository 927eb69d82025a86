// SPDX-License-Identifier: Apache-2.0
// How a picture of a stack lies on another one, where the picture grows, turns or shifts.
#pragma once

namespace fathom {

/// Where a point (x, y) px of the reference picture lies in another one:
/// centre + scale * R(angle) (p - centre) + shift, about the picture's centre.
struct Similarity {
  double scale = 1;
  double angle_rad = 0;  ///< From x to y.
  double dx_px = 0;
  double dy_px = 0;

  bool operator==(const Similarity&) const = default;
};

/// How a picture shows what the reference shows: where, and how much less bright.
struct Seen {
  Similarity place;  ///< Of the reference's pixels in it.
  double gain = 1;   ///< What its greys are multiplied by to be as bright.
};

}  // namespace fathom
