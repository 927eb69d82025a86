// SPDX-License-Identifier: Apache-2.0
// Whether what a search saw is still so when it is over: a scene, a lamp, a lens that lost steps or
// a passer-by changes a curve under way, and any curve has a peak.
#pragma once

#include <span>

#include "noise.hpp"
#include "peak.hpp"
#include "search.hpp"

namespace fathom {

/// Looks again at what the peak stands on: at the places on its slopes that were seen longest ago,
/// and at its top.
void look_again(SearchTrace& trace, const Peak& peak);

/// What the second looks come to.
struct SecondLooks {
  bool agree = true;  ///< Nothing changed beyond noise.
  double shift = 0;   ///< How far the peak seems to have moved since, in the lens's unit.
};

/// Compares every second look with the evaluation of the same place. curve: with these evaluations.
SecondLooks compare_looks(std::span<const Evaluation> looks, const FocusCurve& curve,
                          const Peak& peak, const Scatter& scatter);

}  // namespace fathom
