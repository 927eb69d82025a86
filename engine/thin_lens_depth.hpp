// SPDX-License-Identifier: Apache-2.0
// The depth of field of a thin lens as it is. Eq. 3-3 of the thesis takes X for X - f, which matters
// near the lens: at 1:1 it gives twice as much.
#pragma once

#include "optics.hpp"

namespace fathom::optics {

/// Between which distances a point's disc on the sensor is within the circle of confusion, mm:
/// X f^2/(f^2 + N C (X - f)) and X f^2/(f^2 - N C (X - f)), X the distance that the lens is focused on.
/// The far one is infinite from X = f + f^2/(N C) on. Throws Error(bad_argument) as depth_of_field().
DepthOfField thin_lens_depth_of_field(const Optics& optics, double object_mm);

}  // namespace fathom::optics
