// SPDX-License-Identifier: Apache-2.0
// Adds discs of light of any size to a picture, each at the cost of its height.
#pragma once

#include <vector>

#include "hal/drivers/simulated/scene.hpp"

namespace fathom::simulated {

/// What all discs together leave on a pixel.
struct Spread {
  float light = 0;   ///< Sum of reflectance times weight.
  float weight = 0;  ///< Sum of weights: 1 amid points that lie a pixel apart.
};

/// Points of light, a pixel apart, become discs.
///
/// A row of a disc is a run of equal values. Only where it begins and ends is written down; sums
/// along the rows, once at the end, fill the runs.
class Discs {
 public:
  Discs();

  /// The disc has weight `part` in all. Its middle is a pixel's centre, which may lie beyond the
  /// picture: what falls outside is dropped. radius_px: below half a pixel it stays on its pixel.
  void add(int x, int y, double radius_px, double reflectance, double part);

  /// What all discs add up to, [row][col] of kHeightPx x kWidthPx. Ends the adding.
  std::vector<Spread> sum();

 private:
  void add_chord(int row, double x, double half_px, Spread per_px);
  void add_end(int row, double place_px, Spread per_px);

  std::vector<Spread> changes_;  ///< From the pixel to the left; a column more than the picture.
  std::vector<double> halves_;   ///< Half lengths of the chords of one disc.
};

}  // namespace fathom::simulated
