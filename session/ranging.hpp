// SPDX-License-Identifier: Apache-2.0
// From runs to calibration points and distances: what a verb does while it measures, and a rerun
// afterwards.
#pragma once

#include <span>
#include <vector>

#include "../calibration/likeness.hpp"
#include "run_file.hpp"

namespace fathom {

/// One point for each run that focused on a target at a known distance.
std::vector<CalibrationPoint> calibration_points(std::span<const Run> runs);

/// The peaks of the runs that focused.
std::vector<Peak> focused_peaks(std::span<const Run> runs);

/// What a calibration on this rig should know.
CalibrationConditions conditions_of(const RunSetup& setup);

/// A distance, and how far what it was measured on is from what was calibrated.
struct Ranged {
  Distance distance;
  Likeness likeness;  ///< Of the run that is least like it.
};

/// The distance of the runs that focused, by the file's calibration, which must be there. Throws as
/// range_from_peaks.
Ranged range_of(const RunFile& file, std::span<const Run> runs);

}  // namespace fathom
