// SPDX-License-Identifier: Apache-2.0
// What a machine-vision camera puts into a buffer: any bytes, in any of the formats.
#include "fuzz.hpp"
#include "hal/drivers/aravis/pixels.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fathom;
  using namespace fathom::aravis;
  constexpr std::size_t kHead = 5;
  if (size < kHead) return 0;
  const auto formats = pixel_formats();
  const PixelFormat& format = formats[data[0] % formats.size()];
  const auto use = static_cast<MosaicUse>(data[1] % 4);
  const Layout layout{data[2], data[3], data[4]};
  // Nothing may be thrown at all: a grab counts what is no picture, and goes on.
  const auto frame = to_grey(format, layout, use, {data + kHead, size - kHead});
  if (frame) {
    fuzz::require(frame->width_px() == side_of(layout.width_px, format, use) &&
                      frame->height_px() == side_of(layout.height_px, format, use),
                  "a frame has the size that was agreed");
    fuzz::require(frame->depth() == format.depth(), "and the depth");
    // Two bytes are taken as they are, whatever a camera puts into the upper bits.
    const bool is_exact = format.packing == Packing::pairs || format.packing == Packing::stream;
    for (int y = 0; is_exact && y < frame->height_px(); ++y) {
      for (int x = 0; x < frame->width_px(); ++x)
        fuzz::require(frame->at(x, y) >> format.bits == 0, "no pixel is brighter than its bits");
    }
  }
  return 0;
}
