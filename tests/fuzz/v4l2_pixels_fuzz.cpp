// SPDX-License-Identifier: Apache-2.0
// What a V4L2 camera puts into a buffer: any bytes, in any of the formats.
#include "fuzz.hpp"
#include "hal/drivers/v4l2/pixels.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fathom;
  constexpr std::size_t kHead = 4;
  if (size < kHead) return 0;
  const auto formats = v4l2::pixel_formats();
  const v4l2::PixelFormat& format = formats[data[0] % formats.size()];
  const int width_px = 1 + data[1], height_px = 1 + data[2];
  const std::size_t stride = v4l2::row_bytes(format, width_px) + data[3];
  // Nothing may be thrown at all: a grab counts what does not decode, and goes on.
  const auto frame =
      v4l2::to_grey(format, {width_px, height_px, stride}, {data + kHead, size - kHead});
  if (frame) {
    fuzz::require(frame->width_px() == width_px && frame->height_px() == height_px,
                  "a frame has the size that was agreed");
    fuzz::require(frame->depth() == format.depth, "and the depth");
  }
  return 0;
}
