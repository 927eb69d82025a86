// SPDX-License-Identifier: Apache-2.0
// The pixel formats of machine-vision cameras (PFNC) that are read, and how their bytes become grey.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "engine/frame.hpp"

namespace fathom::aravis {

/// How pixels lie in bytes.
enum class Packing {
  bytes,   ///< One each.
  words,   ///< Two each, low byte first.
  pairs,   ///< GigE Vision's "Packed": two pixels in three bytes, their low bits in the middle one.
  stream,  ///< PFNC's "p": bit after bit, lowest first, without gaps.
};

/// Colours of the first two pixels of the first row; the second row has the other two.
enum class Mosaic { none, gr, rg, gb, bg };

/// What becomes of a colour mosaic.
enum class MosaicUse {
  luma,   ///< Interpolated, of the sensor's size.
  red,    ///< That colour's pixels alone: half as wide and half as high.
  green,  ///< Likewise, of the two greens the one in red's row.
  blue,
};

struct PixelFormat {
  std::uint32_t code;     ///< Of the standard.
  std::string_view name;  ///< Likewise: "Mono12Packed".
  int bits;               ///< Of a pixel's value.
  Packing packing;
  Mosaic mosaic;

  Depth depth() const { return bits > 8 ? Depth::bits16 : Depth::bits8; }
  bool is_mosaic() const { return mosaic != Mosaic::none; }
};

/// All that are read, best for measuring first.
std::span<const PixelFormat> pixel_formats();

/// Null for one that is not read.
const PixelFormat* find_pixel_format(std::uint32_t code);

/// A picture as it was sent.
struct Layout {
  int width_px = 0;
  int height_px = 0;
  std::size_t padding_bytes = 0;  ///< After each row.
};

/// A side of the frame that becomes of a sensor's side.
int side_of(int sensor_px, const PixelFormat& format, MosaicUse use);

/// Nothing where bytes are missing or the picture is too small for its mosaic.
std::optional<Frame> to_grey(const PixelFormat& format, const Layout& layout, MosaicUse use,
                             std::span<const std::uint8_t> bytes);

}  // namespace fathom::aravis
