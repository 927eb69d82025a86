// SPDX-License-Identifier: Apache-2.0
// Pixels that could not take more light: what they would have shown is lost, and a blurred edge of
// theirs looks as sharp as a sharp one.
#pragma once

#include <optional>
#include <span>

#include "../engine/frame.hpp"
#include "../engine/window.hpp"
#include "measurement.hpp"
#include "warning.hpp"

namespace fathom {

/// Part of the window's pixels at the camera's maximum, 0..1. Of 16-bit frames that is 1023, 4095,
/// 16383 or 65535: the lowest that no pixel of the window exceeds, because a 12-bit camera does not
/// say so.
double saturated_part(const Frame& frame, const Window& window);

/// Of the measurement nearest to `position`, where more than 1 % of its window is saturated;
/// nothing where it is not.
std::optional<Saturation> saturation_at(std::span<const Measurement> measurements, double position);

}  // namespace fathom
