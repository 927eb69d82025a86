// SPDX-License-Identifier: Apache-2.0
// Pixels of every kind that is written, and the encoders that take them: colours, floating point,
// colours of a palette.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "../engine/colours.hpp"
#include "../engine/frame.hpp"

namespace fathom {

/// A picture to be written. It looks at somebody's samples, row by row without gaps, in native byte
/// order.
struct Raster {
  enum class Sample { uint8, uint16, float32 };

  const void* samples = nullptr;
  int width_px = 0;
  int height_px = 0;
  int channels = 1;  ///< 1, or 3: red, green, blue.
  Sample sample = Sample::uint8;
  /// Red, green, blue of each value of an 8-bit picture of one channel (PNG only); empty: greys.
  std::span<const std::array<std::uint8_t, 3>> palette = {};
  std::string description = {};  ///< ImageDescription of a TIFF, such as OME-XML; may be empty.

  std::size_t row_bytes() const;
  const std::byte* row(int y) const {
    return static_cast<const std::byte*>(samples) + static_cast<std::size_t>(y) * row_bytes();
  }
};

Raster raster_of(const float* samples, int width_px, int height_px);
Raster raster_of(const std::uint8_t* samples, int width_px, int height_px);
Raster raster_of(const std::uint16_t* samples, int width_px, int height_px);
/// Of a frame without gaps between its rows, which must outlive the raster. Throws
/// Error(bad_argument) for one with gaps: clone() has none.
Raster raster_of(const Frame& frame);
/// Of a picture with colours; they must outlive the raster. Throws Error(bad_argument) where their
/// number is another than the size says.
Raster raster_of(const Colours& colours, int width_px, int height_px);

/// A TIFF of one uncompressed page in one strip, which every program reads; big where it must be.
/// The size in memory is that of the file. Throws Error(out_of_memory).
std::string encode_tiff(const Raster& raster);

/// How much time a PNG is worth.
enum class PngEffort {
  small,  ///< zlib's default level and the filter that suits each row.
  fast,   ///< Level 1 and one filter: a third larger, and five times as fast.
};
/// Throws Error(bad_argument) for floating point, Error(out_of_memory).
std::string encode_png(const Raster& raster, PngEffort effort);

/// A JPEG, for pictures that are looked at and not measured. quality: 1 to 100. Throws
/// Error(bad_argument) for anything but 8 bits, Error(out_of_memory).
std::string encode_jpeg(const Raster& raster, int quality);

}  // namespace fathom
