// SPDX-License-Identifier: Apache-2.0
// The pixel formats that are read, and how each becomes grey.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "engine/frame.hpp"

namespace fathom::v4l2 {

struct PixelFormat {
  std::uint32_t fourcc;   ///< V4L2_PIX_FMT_...
  std::string_view name;  ///< "GREY"; the name of the fourcc in a rig file.
  Depth depth;            ///< Of the frames: what 16 bits hold is not rescaled.
  bool is_compressed;
};

/// All of them, best for measuring first: deep grey, grey, colour with a plain luma, JPEG.
std::span<const PixelFormat> pixel_formats();

/// Null for a format that is not read.
const PixelFormat* find_pixel_format(std::uint32_t fourcc);

/// Where a driver puts the pixels of a picture.
struct Layout {
  int width_px = 0;
  int height_px = 0;
  std::size_t stride_bytes = 0;  ///< Between the starts of two rows; of no meaning for JPEG.
};

/// Bytes that one row takes without gaps: a layout's stride is never less.
std::size_t row_bytes(const PixelFormat& format, int width_px);

/// The grey picture in a buffer's bytes, or nothing for bytes that are too few or do not decode:
/// they come from a device, so anything may be in them. Luma is given as it is, 16..235 where the
/// camera says so: a focus score does not need the ends of the scale.
std::optional<Frame> to_grey(const PixelFormat& format, const Layout& layout,
                             std::span<const std::uint8_t> bytes);

}  // namespace fathom::v4l2
