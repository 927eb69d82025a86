// SPDX-License-Identifier: Apache-2.0
// What a distance has against it, in words.
#pragma once

#include <string>
#include <vector>

#include "calibration/calibration.hpp"
#include "calibration/likeness.hpp"
#include "words/terms.hpp"

namespace fathom {

/// A reason to believe a distance less than its sigma says.
struct CalibrationDoubt {
  /// "calibration-bare", "calibration-poor", "calibration-differs", "object-unknown",
  /// "other-object" or "sigma-widened".
  const char* kind;
  std::string text;  ///< One line without an end.
};

/// Throws Error(bad_argument) for a calibration whose positions have another unit than the lens: its
/// curve would give nonsense.
void require_unit(const Calibration& calibration, const std::string& unit);

/// What a calibration is measured with otherwise than `now`, and what it is worth by itself. What
/// either side does not know is not compared; a unit is not compared at all.
std::vector<CalibrationDoubt> doubts_of(const Calibration& calibration,
                                        const CalibrationConditions& now, const Terms& terms = {});

/// What the object at a position is otherwise than the one that was calibrated.
std::vector<CalibrationDoubt> doubts_of(const Calibration& calibration, const Likeness& likeness,
                                        double position);

/// What the object's likeness adds to a distance's sigma, mm.
double strange_mm(const Calibration& calibration, const Likeness& likeness, double position);

}  // namespace fathom
