// SPDX-License-Identifier: Apache-2.0
#include "pictures/raster.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"

namespace fathom {
namespace {

std::size_t bytes_of(Raster::Sample sample) {
  switch (sample) {
    case Raster::Sample::uint8:
      return 1;
    case Raster::Sample::uint16:
      return 2;
    case Raster::Sample::float32:
      return 4;
  }
  return 0;
}

Raster raster(const void* samples, int width_px, int height_px, Raster::Sample sample) {
  return {.samples = samples, .width_px = width_px, .height_px = height_px, .sample = sample};
}

}  // namespace

std::size_t Raster::row_bytes() const {
  return static_cast<std::size_t>(width_px) * static_cast<std::size_t>(channels) * bytes_of(sample);
}

Raster raster_of(const float* samples, int width_px, int height_px) {
  return raster(samples, width_px, height_px, Raster::Sample::float32);
}

Raster raster_of(const std::uint8_t* samples, int width_px, int height_px) {
  return raster(samples, width_px, height_px, Raster::Sample::uint8);
}

Raster raster_of(const std::uint16_t* samples, int width_px, int height_px) {
  return raster(samples, width_px, height_px, Raster::Sample::uint16);
}

Raster raster_of(const Frame& frame) {
  const Raster result =
      raster(frame.row(0), frame.width_px(), frame.height_px(),
             frame.depth() == Depth::bits16 ? Raster::Sample::uint16 : Raster::Sample::uint8);
  if (frame.stride_bytes() == result.row_bytes()) return result;
  throw Error(ErrorCode::bad_argument, "a frame with gaps between its rows is no raster");
}

Raster raster_of(const Colours& colours, int width_px, int height_px) {
  const bool is_wide = !colours.bits16.empty();
  const std::size_t count = is_wide ? colours.bits16.size() : colours.bits8.size();
  const std::size_t pixels = std::size_t{1} * width_px * height_px;
  if (count != 3 * pixels) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} samples of colour are not 3 for each of {} x {} px", count,
                            width_px, height_px));
  }
  Raster result = is_wide ? raster_of(colours.bits16.data(), width_px, height_px)
                          : raster_of(colours.bits8.data(), width_px, height_px);
  result.channels = 3;
  return result;
}

}  // namespace fathom
