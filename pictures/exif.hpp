// SPDX-License-Identifier: Apache-2.0
// How a camera was held, as EXIF tells it, and pictures turned accordingly: whoever names a window
// has seen the picture upright.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pictures/picture.hpp"

namespace fathom::pictures {

/// The orientation of a picture that is stored as it is seen; EXIF knows 1 to 8.
inline constexpr int kUpright = 1;

/// The orientation, 1 to 8, that a JPEG's APP1 segment tells; nothing for one that is not EXIF, is
/// damaged, or says none.
std::optional<int> exif_orientation(std::span<const std::uint8_t> segment);

/// Whether width and height change places.
constexpr bool lies_on_its_side(int orientation) { return orientation >= 5; }

/// The picture as it should be seen. width_px, height_px: as it is stored; channels: bytes of a pixel.
std::vector<std::uint8_t> turned_upright(std::vector<std::uint8_t> stored, int width_px,
                                         int height_px, int channels, int orientation);

}  // namespace fathom::pictures
