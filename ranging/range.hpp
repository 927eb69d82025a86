// SPDX-License-Identifier: Apache-2.0
// From focused positions to a distance with an honest uncertainty (thesis T15).
#pragma once

#include <span>

#include "calibration.hpp"

namespace fathom {

/// Distance from the positions of one or more focus runs on the same target: the curve at their
/// mean. The sigma of one position is the largest of the calibration's scatter, the runs' own, and
/// that of a position that may lie anywhere in the interval a run ends with (the search's tolerance
/// or the lens's resolution); that of the mean falls with the root of the number of runs, to
/// resolution / sqrt(12). Throws Error(out_of_bounds) for a position that the calibration does not
/// cover, unless extrapolate; Error(bad_argument) for no positions.
Distance range_from_positions(const Calibration& calibration, std::span<const double> positions,
                              double tolerance, double resolution, bool extrapolate);

/// Mean of positions. Throws Error(bad_argument) if there are none.
double mean_position(std::span<const double> positions);

}  // namespace fathom
