// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/pixels.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <vector>

#include "engine/error.hpp"
#include "pictures/picture.hpp"

namespace fathom::v4l2 {
namespace {

constexpr PixelFormat kFormats[] = {
    {V4L2_PIX_FMT_Y16, "Y16", Depth::bits16, false},
    {V4L2_PIX_FMT_Y12, "Y12", Depth::bits16, false},
    {V4L2_PIX_FMT_Y10, "Y10", Depth::bits16, false},
    {V4L2_PIX_FMT_GREY, "GREY", Depth::bits8, false},
    {V4L2_PIX_FMT_NV12, "NV12", Depth::bits8, false},
    {V4L2_PIX_FMT_YUYV, "YUYV", Depth::bits8, false},
    {V4L2_PIX_FMT_MJPEG, "MJPEG", Depth::bits8, true},
    {V4L2_PIX_FMT_JPEG, "JPEG", Depth::bits8, true},
};

/// Bytes without which an uncompressed picture is not whole.
std::size_t least_bytes(const PixelFormat& format, const Layout& layout) {
  const auto height = static_cast<std::size_t>(layout.height_px);
  const std::size_t last_row = row_bytes(format, layout.width_px);
  const std::size_t luma = layout.stride_bytes * (height - 1) + last_row;
  if (format.fourcc != V4L2_PIX_FMT_NV12) return luma;
  const std::size_t chroma_rows = (height + 1) / 2;
  return layout.stride_bytes * (height + chroma_rows - 1) + last_row;
}

/// Rows of 8-bit luma, `step` bytes from one pixel to the next.
Frame from_bytes(const Layout& layout, std::span<const std::uint8_t> bytes, std::size_t step) {
  const auto width = static_cast<std::size_t>(layout.width_px);
  std::vector<std::uint8_t> grey;
  grey.reserve(width * layout.height_px);
  for (int y = 0; y < layout.height_px; ++y) {
    const std::uint8_t* const row = bytes.data() + layout.stride_bytes * y;
    if (step == 1) {
      grey.insert(grey.end(), row, row + width);
      continue;
    }
    for (std::size_t x = 0; x < width; ++x) grey.push_back(row[x * step]);
  }
  return Frame(layout.width_px, layout.height_px, std::move(grey));
}

/// Rows of 16-bit pixels, low byte first whatever this machine's own order is.
Frame from_words(const Layout& layout, std::span<const std::uint8_t> bytes) {
  std::vector<std::uint16_t> grey;
  grey.reserve(static_cast<std::size_t>(layout.width_px) * layout.height_px);
  for (int y = 0; y < layout.height_px; ++y) {
    const std::uint8_t* const row = bytes.data() + layout.stride_bytes * y;
    for (std::size_t x = 0; x < static_cast<std::size_t>(layout.width_px); ++x) {
      grey.push_back(static_cast<std::uint16_t>(row[2 * x] | row[2 * x + 1] << 8));
    }
  }
  return Frame(layout.width_px, layout.height_px, std::move(grey));
}

std::optional<Frame> from_jpeg(const Layout& layout, std::span<const std::uint8_t> bytes) {
  try {
    PictureFile picture({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "frame");
    const PictureShape wanted{layout.width_px, layout.height_px, Depth::bits8};
    if (picture.format() != PictureFormat::jpeg || picture.shape() != wanted) return std::nullopt;
    return picture.read();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::out_of_memory) throw;
    return std::nullopt;
  }
}

}  // namespace

std::span<const PixelFormat> pixel_formats() { return kFormats; }

const PixelFormat* find_pixel_format(std::uint32_t fourcc) {
  const auto* const found =
      std::find_if(std::begin(kFormats), std::end(kFormats),
                   [&](const PixelFormat& format) { return format.fourcc == fourcc; });
  return found == std::end(kFormats) ? nullptr : found;
}

std::size_t row_bytes(const PixelFormat& format, int width_px) {
  if (format.is_compressed) return 0;
  const auto width = static_cast<std::size_t>(width_px);
  // Two pixels of YUYV share their colour, and two columns of NV12: an odd last one has a whole
  // pair.
  if (format.fourcc == V4L2_PIX_FMT_YUYV) return (width + 1) / 2 * 4;
  if (format.fourcc == V4L2_PIX_FMT_NV12) return (width + 1) / 2 * 2;
  return width * bytes_per_pixel(format.depth);
}

std::optional<Frame> to_grey(const PixelFormat& format, const Layout& layout,
                             std::span<const std::uint8_t> bytes) {
  if (format.is_compressed) return from_jpeg(layout, bytes);
  if (bytes.size() < least_bytes(format, layout)) return std::nullopt;
  if (format.depth == Depth::bits16) return from_words(layout, bytes);
  return from_bytes(layout, bytes, format.fourcc == V4L2_PIX_FMT_YUYV ? 2 : 1);
}

}  // namespace fathom::v4l2
