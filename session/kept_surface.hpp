// SPDX-License-Identifier: Apache-2.0
// A surface of the picture, as a run keeps it: what its distance follows from.
#pragma once

#include <optional>

#include "../calibration/calibration.hpp"
#include "../engine/window.hpp"

namespace fathom {

/// A surface of the picture as a run file keeps it.
struct KeptSurface {
  double position = 0;  ///< Mean over its area, in the lens's unit,
  double sigma = 0;     ///< how sure that is,
  double relief = 0;    ///< and how far its places lie from it, root mean square.
  int x = 0, y = 0, width_px = 0, height_px = 0;  ///< The box that holds it.
  double area = 0;                                ///< Its part of the picture, 0 to 1.
  double texture = 0;                             ///< Its part of the picture's texture, 0 to 1.
  std::optional<Window> window = {};              ///< Where it may be measured by itself.
  std::optional<Distance> distance = {};          ///< Nothing without a calibration that covers it.
};

/// Of any of its places, in the lens's unit: sigma and relief.
double place_sigma(const KeptSurface& surface);

/// The mean distance over its area; sigma is that of any of its places. Nothing where the calibration
/// does not cover its position and nobody extrapolates, or where that focuses nothing.
std::optional<Distance> distance_of(const Calibration& calibration, const KeptSurface& surface,
                                    bool extrapolate);

}  // namespace fathom
