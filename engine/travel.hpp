// SPDX-License-Identifier: Apache-2.0
// What a lens is and which positions it can take: numbers, so that a search, a run file and a real
// lens follow one rule.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "optics.hpp"

namespace fathom {

/// What a lens is, in its own unit.
struct LensInfo {
  std::string description;  ///< One line for logs and run files: driver, model.
  std::string unit;         ///< "steps", "frames", "um", "dioptres": the unit of every position.
  double lowest = 0;        ///< First position it can take.
  double highest = 0;       ///< Last position it can take.
  double resolution = 1;    ///< Smallest move that means anything.

  /// Widest spacing at which no focus peak hides between two samples; what a coarse pass uses.
  /// Follows from the optics where they are known, from the recording's own spacing for a replay; 0
  /// where nobody knows: a search then finds it by halving.
  double coarse_spacing = 1;

  /// The only positions that it can take, increasing, where they are not simply every multiple of
  /// the resolution from `lowest` on (a recorded stack with uneven gaps).
  std::vector<double> stops;

  /// Focal length, aperture and circle of confusion, where they are known: what a depth of field
  /// follows from.
  std::optional<Optics> optics = std::nullopt;

  /// Diameter of the disc of confusion, px, that each unit of travel away from the focus adds, where
  /// optics and the camera's pixels tell it.
  std::optional<double> blur_px_per_unit = std::nullopt;

  /// Of a recording: which picture each of `stops` is ("pcb_012.png", "stack.tif page 12"). Empty,
  /// or as many as `stops`.
  std::vector<std::string> stop_names = {};
};

/// The position that a lens would take when asked for another: the nearest that it has, the lower
/// of two that are equally near. One rule for every lens, so that a run can be computed again
/// without it.
double nearest_position(const LensInfo& info, double position);

/// Which picture was recorded nearest to a position; empty where the lens is no recording.
std::string nearest_name(const LensInfo& info, double position);

/// Throws Error(bad_argument) for a position that is not a number, Error(out_of_bounds) for one
/// beyond the travel.
void require_within(const LensInfo& info, double position);

}  // namespace fathom
