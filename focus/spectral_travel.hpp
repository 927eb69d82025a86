// SPDX-License-Identifier: Apache-2.0
// The way to a focus without a halt: pictures that are taken on it tell the side and the place.
#pragma once

#include <span>
#include <vector>

#include "search.hpp"
#include "spectral.hpp"

namespace fathom {

struct FocusLimits;

/// Whether a picture on the way tells as much as one at rest would. since_before: from where the
/// picture before it was taken, in the lens's unit.
bool is_worth_it(const OnTheWay& way, double since_before, const BlurModel& model);

/// How the way ended.
enum class WayEnd {
  told,             ///< The fit says where the focus is. It is near, or was passed.
  nothing_changes,  ///< A long way changed nothing beyond noise.
  unclear,          ///< Pictures at rest must tell.
};

struct Way {
  WayEnd end = WayEnd::unclear;
  SpectralFit fit = {};  ///< Where it was told; to begin with, one that has misled.
  double here = 0;       ///< Where the last picture was taken.
  int direction = 1;     ///< In which the lens went last: 1 up, -1 down.
};

/// Goes on from where a way ended, first in its direction, and turns round where the focus is behind
/// for certain; no farther than the limits. It ends before the place from which the focus would be
/// passed, or once it has been passed. trace: one picture at least; it can travel.
Way go_by_spectra(SearchTrace& trace, const FocusLimits& limits, const Way& begin);

/// Those of the pictures on the way that show what no focus is, a hop apart: none nearer to the focus
/// than its floor, and none in which the way shows.
std::vector<Evaluation> floor_of_way(const SearchTrace& trace, double focus,
                                     const BlurModel& model);

/// All pictures of a trace, no two of those on the way nearer to each other than `apart`.
std::vector<Evaluation> thinned(const SearchTrace& trace, double apart);

}  // namespace fathom
