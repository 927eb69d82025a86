// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <png.h>

#include "engine/error.hpp"
#include "make_pictures.hpp"
#include "pictures/grey.hpp"
#include "pictures/picture.hpp"

namespace fathom::test {
namespace {

Frame read(const std::string& bytes) { return PictureFile(bytes, "made.png").read(); }

std::vector<std::uint8_t> bytes_of(const std::vector<std::uint16_t>& values, int bit_depth) {
  std::vector<std::uint8_t> bytes;
  for (const auto value : values) {
    if (bit_depth == 16) bytes.push_back(static_cast<std::uint8_t>(value >> 8));
    bytes.push_back(static_cast<std::uint8_t>(value & 0xff));
  }
  return bytes;
}

TEST(Luma, IsTheRoundedFormulaForEveryCornerAndManyColours) {
  using pictures::luma;
  for (std::uint32_t r = 0; r < 256; r += 3) {
    for (std::uint32_t g = 0; g < 256; g += 5) {
      for (std::uint32_t b = 0; b < 256; b += 1) {
        ASSERT_EQ(luma(static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g),
                       static_cast<std::uint8_t>(b)),
                  expected_luma(r, g, b))
            << r << ' ' << g << ' ' << b;
      }
    }
  }
  EXPECT_EQ(luma<std::uint16_t>(65535, 65535, 65535), 65535);
  EXPECT_EQ(luma<std::uint16_t>(65535, 0, 0), 19595);
  EXPECT_EQ(luma<std::uint8_t>(255, 255, 255), 255);
  // 299 + 587 * 2 + 114 * 0.25 ... a sum that ends in exactly one half: 500 green = 293.5.
  EXPECT_EQ(luma<std::uint16_t>(0, 500, 0), 294);
}

class PngGrey : public testing::TestWithParam<bool> {};

TEST_P(PngGrey, EightBitKeepsItsValues) {
  const auto values = noise(13 * 11, 255, 1);
  const Frame frame = read(make_png(
      {.width = 13, .height = 11, .interlaced = GetParam(), .packed_rows = bytes_of(values, 8)}));
  EXPECT_EQ(frame.depth(), Depth::bits8);
  EXPECT_EQ(frame.width_px(), 13);
  EXPECT_EQ(frame.height_px(), 11);
  EXPECT_EQ(values_of(frame), std::vector<std::uint32_t>(values.begin(), values.end()));
}

TEST_P(PngGrey, SixteenBitComesInNativeOrder) {
  const auto values = noise(13 * 11, 65535, 2);
  const Frame frame = read(make_png({.width = 13,
                                     .height = 11,
                                     .bit_depth = 16,
                                     .interlaced = GetParam(),
                                     .packed_rows = bytes_of(values, 16)}));
  EXPECT_EQ(frame.depth(), Depth::bits16);
  EXPECT_EQ(values_of(frame), std::vector<std::uint32_t>(values.begin(), values.end()));
}

TEST_P(PngGrey, ColourBecomesLuma) {
  for (const int bits : {8, 16}) {
    for (const bool alpha : {false, true}) {
      const std::size_t samples = alpha ? 4 : 3;
      const auto values = noise(7 * 9 * samples, bits == 8 ? 255 : 65535, 3);
      const Frame frame =
          read(make_png({.width = 7,
                         .height = 9,
                         .bit_depth = bits,
                         .colour_type = alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB,
                         .interlaced = GetParam(),
                         .packed_rows = bytes_of(values, bits)}));
      std::vector<std::uint32_t> wanted;
      for (std::size_t i = 0; i < values.size(); i += samples) {
        wanted.push_back(expected_luma(values[i], values[i + 1], values[i + 2]));
      }
      EXPECT_EQ(values_of(frame), wanted) << bits << " bit, alpha " << alpha;
    }
  }
}

TEST_P(PngGrey, GreyWithAlphaDropsTheAlpha) {
  const auto values = noise(5 * 4 * 2, 65535, 4);
  const Frame frame = read(make_png({.width = 5,
                                     .height = 4,
                                     .bit_depth = 16,
                                     .colour_type = PNG_COLOR_TYPE_GRAY_ALPHA,
                                     .interlaced = GetParam(),
                                     .packed_rows = bytes_of(values, 16)}));
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(values_of(frame)[i], values[2 * i]);
}

INSTANTIATE_TEST_SUITE_P(Interlacing, PngGrey, testing::Bool());

TEST(Png, FewBitsAreSpreadOver255) {
  // One row of eight pixels: 1, 2 and 4 bits.
  EXPECT_EQ(values_of(read(
                make_png({.width = 8, .height = 1, .bit_depth = 1, .packed_rows = {0b10100101}}))),
            (std::vector<std::uint32_t>{255, 0, 255, 0, 0, 255, 0, 255}));
  EXPECT_EQ(values_of(read(
                make_png({.width = 4, .height = 1, .bit_depth = 2, .packed_rows = {0b00011011}}))),
            (std::vector<std::uint32_t>{0, 85, 170, 255}));
  EXPECT_EQ(
      values_of(read(make_png({.width = 2, .height = 1, .bit_depth = 4, .packed_rows = {0x1f}}))),
      (std::vector<std::uint32_t>{17, 255}));
}

TEST(Png, PaletteBecomesLumaWhateverItsTransparency) {
  const std::vector<std::uint8_t> palette = {10, 20, 30, 200, 100, 50, 0, 0, 255};
  for (const bool transparent : {false, true}) {
    const Frame frame =
        read(make_png({.width = 4,
                       .height = 1,
                       .bit_depth = 2,
                       .colour_type = PNG_COLOR_TYPE_PALETTE,
                       .packed_rows = {0b00011000},
                       .palette = palette,
                       .transparency = transparent ? std::vector<std::uint8_t>{0, 128, 255}
                                                   : std::vector<std::uint8_t>{}}));
    EXPECT_EQ(values_of(frame),
              (std::vector<std::uint32_t>{expected_luma(10, 20, 30), expected_luma(200, 100, 50),
                                          expected_luma(0, 0, 255), expected_luma(10, 20, 30)}));
  }
}

TEST(Png, HeaderClaimingGigapixelsIsRefusedFromItsSize) {
  std::string file =
      make_png({.width = 8, .height = 1, .packed_rows = std::vector<std::uint8_t>(8)});
  // The width stands at byte 16, big-endian; the chunk's checksum at byte 29 is then wrong, which
  // is refused first. So make one that is right.
  const auto put = [&file](std::size_t at, std::uint32_t value) {
    for (int i = 0; i < 4; ++i)
      file[at + static_cast<std::size_t>(i)] = static_cast<char>(value >> (24 - 8 * i));
  };
  const auto crc = [&file] {
    std::uint32_t sum = 0xffffffff;
    for (std::size_t i = 12; i < 29; ++i) {
      sum ^= static_cast<unsigned char>(file[i]);
      for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ ((sum & 1) != 0 ? 0xedb88320u : 0u);
    }
    return ~sum;
  };
  for (const auto& [width, height] : {std::pair{65536u, 65536u}, {70000u, 1u}, {20000u, 10000u}}) {
    put(16, width);
    put(20, height);
    put(29, crc());
    try {
      read(file);
      FAIL() << width << " x " << height << " was read";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_data) << error.what();
      EXPECT_NE(std::string(error.what()).find("made.png"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace fathom::test
