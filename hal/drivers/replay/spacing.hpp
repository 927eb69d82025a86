// SPDX-License-Identifier: Apache-2.0
// What the positions of a recording say of its travel.
#pragma once

#include <span>

namespace fathom::replay {

/// LensInfo::resolution: the smallest distance between two neighbours; 1 where there is only one
/// position. positions: increasing.
double smallest_gap(std::span<const double> positions);

/// LensInfo::coarse_spacing: every position of a few, else wide enough for 128 samples and a
/// multiple of the smallest gap. positions: increasing, at least one.
double coarse_spacing_of(std::span<const double> positions);

}  // namespace fathom::replay
