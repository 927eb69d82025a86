// SPDX-License-Identifier: Apache-2.0
// The lenses that the simulated rig can have: what a position of each is, in millimetres and pixels.
#pragma once

#include <string_view>

namespace fathom::simulated {

/// Numbers and formulas of one lens and the camera that it is built into. Positions go from 0 to
/// `travel`; distances are of objects from the lens.
struct Objective {
  std::string_view name;  ///< As a rig text says it.
  std::string_view unit;
  int travel;
  double focal_mm;
  double usual_f_number;
  double nearest_target_mm, farthest_target_mm, usual_distance_mm;
  double rate_per_s;  ///< Positions that it passes in a second,
  double stall_rate;  ///< and above which it does not follow.
  int play;           ///< Of its gears, in positions.
  bool breathes;      ///< Whether the picture grows as it focuses nearer.
  bool is_compressed;
  bool tells_optics;

  /// Of the object in focus; infinity where it focuses beyond that.
  double (*focused_distance_mm)(double position);
  /// Diameter of the disc of confusion, mm on a sensor whose pixels are kPitchMm wide.
  double (*disc_mm)(double position, double distance_mm, double f_number);
  /// Side of a pixel on an object at a distance, mm, as the picture is while the lens stands there.
  double (*pixel_on_object_mm)(double position, double distance_mm);
};

/// The thesis' lens, 135 mm, moved by a stepper motor (thin_lens.hpp).
const Objective& thesis_objective();

/// A webcam with a voice coil: 4 mm, f/2, pixels of 6 um, 0 to 255 in equal steps of focusing power,
/// from half a dioptre beyond infinity to 100 mm.
const Objective& webcam_objective();

}  // namespace fathom::simulated
