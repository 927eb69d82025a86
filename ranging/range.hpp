// SPDX-License-Identifier: Apache-2.0
// From focused positions to a distance with an honest uncertainty (thesis T15).
#pragma once

#include <span>

#include "calibration.hpp"

namespace fathom {

/// Distance from the positions of one or more focus runs on the same target: the curve at their
/// mean. The sigma of the position is the larger of the calibration's scatter and the runs' own,
/// over the root of the number of runs, never below the lens's resolution / sqrt(12). Throws
/// Error(out_of_bounds) for a position that the calibration does not cover, unless extrapolate;
/// Error(bad_argument) for no positions.
Distance range_from_positions(const Calibration& calibration, std::span<const double> positions,
                              double resolution, bool extrapolate);

/// Mean of positions. Throws Error(bad_argument) if there are none.
double mean_position(std::span<const double> positions);

}  // namespace fathom
