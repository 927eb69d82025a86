// SPDX-License-Identifier: Apache-2.0
// The pictures of the Alpaca protocol: ImageBytes (version 1) and JSON image arrays.
#pragma once

#include <span>
#include <string_view>

#include "engine/frame.hpp"

namespace fathom::alpaca {

struct ImageShape {
  int width_px = 0;
  int height_px = 0;
  Depth depth = Depth::bits16;
};

/// Both stand column by column, the first column first. Colour planes become luma. Throws
/// Error(bad_data) for what is no such picture, or not of this shape; what the server says instead of
/// a picture as require_no_error().
Frame frame_of_bytes(std::span<const std::uint8_t> bytes, const ImageShape& shape);
Frame frame_of_json(std::string_view text, const ImageShape& shape);

}  // namespace fathom::alpaca
