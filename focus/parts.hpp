// SPDX-License-Identifier: Apache-2.0
// Whether all of a window is at one distance: where each of its parts is sharpest.
#pragma once

#include <span>
#include <vector>

#include "curve.hpp"
#include "noise.hpp"
#include "peak.hpp"

namespace fathom {

/// What the parts of a window say. Positions in the lens's unit.
struct Depths {
  std::vector<Peak> parts;  ///< Of the parts that have a clear peak of their own, nearest to lowest
                            ///< position first.
  double spread = 0;        ///< Their standard deviation, beyond what their own sigmas explain.

  /// The two heaps that the parts fall into, where no position has both sharp: their middles, that
  /// of the higher peaks first, and the height of the second over that of the first.
  struct Two {
    double first = 0, second = 0;
    double second_part = 0;  ///< 0 where there are no two.
  };
  Two two;
};

/// evaluations: in any order, with the scores of their parts; Nothing is found where the parts are not known.
Depths depths_of(const std::vector<Evaluation>& evaluations, const Scatter& part_scatter);

}  // namespace fathom
