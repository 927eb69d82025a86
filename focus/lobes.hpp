// SPDX-License-Identifier: Apache-2.0
// The hills of a focus curve, so that a second one is never overlooked: two objects at different
// distances in one window, or a specimen with two sharp planes.
#pragma once

#include <vector>

#include "curve.hpp"

namespace fathom {

/// One hill of a curve.
struct Lobe {
  std::size_t best = 0;   ///< Index of its highest evaluation.
  std::size_t first = 0;  ///< Where it begins and
  std::size_t last = 0;   ///< ends: the dips to either side, or the curve's ends.
  double height = 0;      ///< Score of its top above the floor.
  double prominence = 0;  ///< Score of its top above the higher one of its two dips.
};

/// Running means over `width` evaluations that follow each other, an odd number, fewer at the ends:
/// what to look for lobes in where each score drowns in noise.
FocusCurve smoothed(const FocusCurve& curve, std::size_t width);

/// The lobes whose prominence is at least `least`, the highest first; at least the one round the
/// best evaluation, if there is any evaluation. Dips of less than that are noise, and part of the
/// lobe.
std::vector<Lobe> find_lobes(const FocusCurve& curve, double least);

}  // namespace fathom
