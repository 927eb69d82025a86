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

/// The highest grey value of a camera whose highest pixel is `highest`: 255 or, of 16-bit frames,
/// 1023, 4095, 16383 or 65535.
std::uint32_t full_scale(Depth depth, std::uint32_t highest);

/// Part of the window's pixels at the camera's maximum, 0..1. Of 16-bit frames that is the
/// highest value of 10, 12 or 14 bits, in the low or the high bits, or 65535: the lowest that no
/// pixel of the window exceeds, because a 12-bit camera does not say so.
double saturated_part(const Frame& frame, const Window& window);

/// Of the measurement nearest to `position`, where more than 1 % of its window is saturated;
/// nothing where it is not.
std::optional<Saturation> saturation_at(std::span<const Measurement> measurements, double position);

}  // namespace fathom
