// SPDX-License-Identifier: Apache-2.0
// From focused positions to a distance with an honest uncertainty (thesis T15).
#pragma once

#include <span>

#include "../focus/peak.hpp"
#include "calibration.hpp"

namespace fathom {

/// Distance from the peaks of one or more focus runs on the same target: the curve at their mean
/// position. The sigma of one position is the larger one of Calibration::run_sigma() and of the
/// runs' own scatter; that of the mean falls with the root of the number of runs, though of
/// positions that were evaluated, not fitted, never below resolution / sqrt(12). lasting_sigma: of
/// the position, by what all runs share, as Likeness::sigma. Throws Error(out_of_bounds) for a
/// position that the calibration does not cover, unless extrapolate; Error(bad_argument) for no
/// peaks.
Distance range_from_peaks(const Calibration& calibration, std::span<const Peak> peaks,
                          double resolution, bool extrapolate, double lasting_sigma = 0);

/// Mean of the peaks' positions. Throws Error(bad_argument) if there are none.
double mean_position(std::span<const Peak> peaks);

}  // namespace fathom
