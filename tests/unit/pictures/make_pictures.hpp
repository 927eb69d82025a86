// SPDX-License-Identifier: Apache-2.0
// Picture files made for tests, by the libraries' own writers and not by Fathom's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/frame.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::test {

struct PngMaker {
  int width = 0;
  int height = 0;
  int bit_depth = 8;
  int colour_type = 0;  // PNG_COLOR_TYPE_*
  bool interlaced = false;
  std::vector<std::uint8_t> packed_rows = {};  // as they stand in the file: big-endian, bits packed
  std::vector<std::uint8_t> palette = {};      // red, green, blue, ...
  std::vector<std::uint8_t> transparency = {};
};
std::string make_png(const PngMaker& maker);

struct JpegMaker {
  int width = 0;
  int height = 0;
  int channels = 3;  // 1 grey, 3 RGB, 4 CMYK
  bool progressive = false;
  std::vector<std::uint8_t> samples = {};  // interleaved
};
std::string make_jpeg(const JpegMaker& maker);

struct TiffMaker {
  int width = 0;
  int height = 0;
  int bits = 8;
  int samples = 1;
  int photometric = 1;  // PHOTOMETRIC_*
  int compression = 1;  // COMPRESSION_*
  int sample_format = 1;
  int tile = 0;  // side of a tile, 0 for strips
  int rows_per_strip = 3;
  bool big_endian = false;
  bool big_tiff = false;
  bool separate_planes = false;
  int pages = 1;
  std::string description = {};             // of the first page
  std::vector<std::uint16_t> values = {};   // [page][row][column][sample], or 8-bit values
  std::vector<std::uint16_t> palette = {};  // 256 reds, 256 greens, 256 blues
};
std::string make_tiff(const TiffMaker& maker);

/// Repeatable noise, 0 .. largest.
std::vector<std::uint16_t> noise(std::size_t count, std::uint32_t largest, std::uint32_t seed);

/// A frame of noise.
Frame noise_frame(int width, int height, Depth depth, std::uint32_t seed);

/// The frame's values, row by row.
std::vector<std::uint32_t> values_of(const Frame& frame);

/// The luma that the contract promises, in floating point: an independent way to it.
std::uint32_t expected_luma(double red, double green, double blue);

}  // namespace fathom::test
