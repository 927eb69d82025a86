// SPDX-License-Identifier: Apache-2.0
// The default search: no interval halving that a local maximum can trap, but a coarse pass that
// sees the whole range, and then a few evaluations where they tell most about the peak's place.
#pragma once

#include "noise.hpp"
#include "search.hpp"

namespace fathom {

/// What the coarse pass is told.
struct CoarsePass {
  std::vector<double> positions;  ///< Increasing.
  /// How often the intervals may be halved: where nothing stands out, or, if the spacing was a
  /// guess, where fewer than three positions lie on the upper half of the best peak.
  int halvings = 0;
  bool is_guess = false;  ///< Nothing is known of the lens's depth of focus.

  bool operator==(const CoarsePass&) const = default;
};

/// Evaluates the positions, and halves the intervals as often as it must and may.
void run_coarse_pass(SearchTrace& trace, const CoarsePass& pass, const Scatter& scatter);

/// Evaluations that a peak may cost after the coarse pass.
inline constexpr int kRefinements = 6;

/// Up to kRefinements evaluations more between low and high, round the best one there: where the
/// fit says the peak is, and on both of its slopes, where a score changes most per step. Ends
/// earlier when the peak's sigma is below an eighth of the tolerance.
void refine_peak(SearchTrace& trace, double low, double high, double repeat_scatter,
                 double tolerance);

/// A coarse pass, then refine_peak() for every lobe that could be the focus, between the neighbours
/// of its best position.
void auto_search(SearchTrace& trace, const CoarsePass& pass, const Scatter& scatter,
                 double tolerance);

}  // namespace fathom
