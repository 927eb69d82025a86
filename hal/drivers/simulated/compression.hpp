// SPDX-License-Identifier: Apache-2.0
// What a webcam's compression leaves of a picture: that of JPEG, without its entropy coding.
#pragma once

#include <cstdint>
#include <span>

namespace fathom::simulated {

/// Rounds the coefficients of each block of 8 x 8 pixels as JPEG does at quality 90. Sides that are
/// no multiples of 8 leave the rest of the picture as it is. pixels: row by row.
void compress(std::span<std::uint8_t> pixels, int width_px);

}  // namespace fathom::simulated
