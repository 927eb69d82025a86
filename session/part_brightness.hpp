// SPDX-License-Identifier: Apache-2.0
// How bright each part of a window is: a lamp or a shadow may reach some of them alone.
#pragma once

#include <array>

#include "../engine/frame.hpp"
#include "../engine/window.hpp"
#include "../focus/sample.hpp"

namespace fathom {

/// Mean grey values of the window's parts, as PictureFacts has them. Each is of half the side, so
/// the side is a multiple of 4.
std::array<double, kParts> part_brightness(const Frame& frame, const Window& window);

}  // namespace fathom
