// SPDX-License-Identifier: Apache-2.0
// What cameras and files make of white noise: neighbouring pixels share it.
#pragma once

#include <vector>

namespace fathom::honesty {

enum class Grain {
  white,       ///< As it is.
  jpeg,        ///< Kept as a JPEG.
  demosaiced,  ///< Of a Bayer sensor, the colours between its pixels interpolated.
  smoothed,    ///< Blurred.
  denoised,    ///< Weak wavelets taken away.
};

/// greys: side x side pixels with white noise, side a multiple of 8; what the camera gives of them.
/// strength, 0..1, chooses within what is usual: JPEG qualities from 95 to 30, blurs from 0.7 to 2
/// pixels, wavelets up to 3 deviations.
std::vector<double> grained(std::vector<double> greys, int side, Grain grain, double strength,
                            double deviation);

}  // namespace fathom::honesty
