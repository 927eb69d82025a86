// SPDX-License-Identifier: Apache-2.0
// The geometry of the thesis rig: one thin lens, moved by a stepper motor. The formulas are those
// of engine/optics.hpp; here they are put in steps of this lens.
#pragma once

#include "engine/optics.hpp"

namespace fathom::simulated {

inline constexpr int kTravelSteps = 1200;      ///< Position 0 is infinity (thesis T10).
inline constexpr double kFocalLengthMm = 135;  ///< The thesis' lens.
inline constexpr double kNearestMm = 1219;     ///< Distance in focus at kTravelSteps (4 ft).
inline constexpr double kPitchMm = 0.04;       ///< Distance between two pixels (thesis T1).

/// How far the lens stands out from its place at infinity, mm: proportional to the steps.
double extension_mm(double position_steps);

/// Distance of the object that is in focus at a position, mm, by the thin-lens formula (eq. 3-1).
/// Infinite at position 0.
double focused_distance_mm(double position_steps);

/// Position at which an object at this distance (beyond the focal length) is in focus, steps; not
/// rounded, and beyond the travel for an object nearer than kNearestMm.
double focused_position_steps(double distance_mm);

/// Diameter on the sensor of the disc of confusion of a point at this distance, mm.
double disc_of_confusion_mm(double position_steps, double distance_mm, double f_number);

/// Millimetres on the sensor of one millimetre on the object. Taken at best focus and kept
/// while the lens moves, as the thesis does.
double magnification(double distance_mm);

}  // namespace fathom::simulated
