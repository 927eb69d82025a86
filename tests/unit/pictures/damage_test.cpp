// SPDX-License-Identifier: Apache-2.0
// Whatever the bytes, reading ends in a frame of the size that the header named or in an Error.
#include <gtest/gtest.h>
#include <png.h>
#include <tiffio.h>

#include <random>

#include "engine/error.hpp"
#include "make_pictures.hpp"
#include "pictures/picture.hpp"

namespace fathom::test {
namespace {

struct Sample {
  const char* name;
  std::string bytes;
};

std::vector<std::uint8_t> bytes_8(const std::vector<std::uint16_t>& values) {
  return {values.begin(), values.end()};
}

std::vector<Sample> samples() {
  TiffMaker tiled{.width = 20,
                  .height = 18,
                  .bits = 16,
                  .compression = COMPRESSION_LZW,
                  .tile = 16,
                  .pages = 2};
  tiled.values = noise(20 * 18 * 2, 65535, 11);
  TiffMaker strips{.width = 20,
                   .height = 18,
                   .samples = 3,
                   .photometric = PHOTOMETRIC_RGB,
                   .compression = COMPRESSION_ADOBE_DEFLATE,
                   .big_endian = true};
  strips.values = noise(20 * 18 * 3, 255, 12);
  return {
      {"png 8", make_png({.width = 20, .height = 18, .packed_rows = bytes_8(noise(360, 255, 13))})},
      {"png interlaced 16-bit colour", make_png({.width = 20,
                                                 .height = 18,
                                                 .bit_depth = 16,
                                                 .colour_type = PNG_COLOR_TYPE_RGB,
                                                 .interlaced = true,
                                                 .packed_rows = bytes_8(noise(360 * 6, 255, 14))})},
      {"jpeg",
       make_jpeg(
           {.width = 20, .height = 18, .channels = 3, .samples = bytes_8(noise(1080, 255, 15))})},
      {"jpeg progressive grey", make_jpeg({.width = 20,
                                           .height = 18,
                                           .channels = 1,
                                           .progressive = true,
                                           .samples = bytes_8(noise(360, 255, 16))})},
      {"tiff tiled", make_tiff(tiled)},
      {"tiff strips", make_tiff(strips)},
      {"pgm", "P5 6 4 255 0123456789abcdef01234567"},
      {"ppm ascii", "P3 2 2 1000 1 20 300  4 5 6  7 8 9  10 11 12"},
  };
}

/// Reads every page; true if all came.
bool read_all(std::string_view bytes, const char* name) {
  try {
    PictureFile file(bytes, name);
    for (std::size_t page = 0; page < file.page_count(); ++page) {
      const PictureShape shape = file.shape(page);
      const Frame frame = file.read(page);
      EXPECT_EQ(shape, (PictureShape{frame.width_px(), frame.height_px(), frame.depth()})) << name;
    }
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return false;
  }
}

TEST(DamagedPictures, CutAnywhereAreRefused) {
  for (const Sample& sample : samples()) {
    ASSERT_TRUE(read_all(sample.bytes, sample.name)) << sample.name;
    const std::string_view whole = sample.bytes;
    // The last number of an ASCII picture may lose a digit and is still a number.
    const std::size_t longest = whole.starts_with("P3") ? whole.size() - 2 : whole.size() - 1;
    for (std::size_t size = 0; size <= longest; ++size) {
      EXPECT_FALSE(read_all(whole.substr(0, size), sample.name))
          << sample.name << ": " << size << " of " << whole.size() << " bytes were enough";
    }
  }
}

TEST(DamagedPictures, FlippedBytesGiveAFrameOrAnError) {
  std::mt19937 random(17);
  for (const Sample& sample : samples()) {
    for (int round = 0; round < 1500; ++round) {
      std::string bytes = sample.bytes;
      for (unsigned flips = 1 + random() % 4; flips > 0; --flips) {
        bytes[random() % bytes.size()] = static_cast<char>(random());
      }
      read_all(bytes, sample.name);
    }
  }
}

}  // namespace
}  // namespace fathom::test
