// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tiffio.h>

#include <tuple>

#include "engine/error.hpp"
#include "make_pictures.hpp"
#include "pictures/picture.hpp"

namespace fathom::test {
namespace {

constexpr int kWidth = 37;
constexpr int kHeight = 29;
constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;

std::vector<std::uint32_t> grey_of(const TiffMaker& maker) {
  std::vector<std::uint32_t> wanted;
  for (std::size_t i = 0; i < maker.values.size(); i += static_cast<std::size_t>(maker.samples)) {
    const std::uint32_t first = maker.values[i];
    const std::uint32_t largest = maker.bits == 8 ? 255 : 65535;
    if (maker.photometric == PHOTOMETRIC_MINISWHITE) {
      wanted.push_back(largest - first);
    } else if (maker.photometric == PHOTOMETRIC_RGB) {
      wanted.push_back(expected_luma(first, maker.values[i + 1], maker.values[i + 2]));
    } else {
      wanted.push_back(first);
    }
  }
  return wanted;
}

std::string error_of(const TiffMaker& maker) {
  try {
    const std::string file = make_tiff(maker);
    PictureFile(file, "made.tif").read();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_data);
    return error.what();
  }
  ADD_FAILURE() << "was read";
  return "";
}

using Kind = std::tuple<int, int, int, int, bool, bool>;
class TiffKinds : public testing::TestWithParam<Kind> {};

TEST_P(TiffKinds, AreReadExactly) {
  const auto [bits, photometric, compression, tile, big_endian, separate] = GetParam();
  TiffMaker maker{.width = kWidth, .height = kHeight, .bits = bits};
  maker.samples = photometric == PHOTOMETRIC_RGB ? 3 : 1;
  maker.photometric = photometric;
  maker.compression = compression;
  maker.tile = tile;
  maker.big_endian = big_endian;
  maker.separate_planes = separate;
  maker.values =
      noise(kPixels * static_cast<std::size_t>(maker.samples), bits == 8 ? 255 : 65535, 5);
  const std::string file = make_tiff(maker);
  const Frame frame = PictureFile(file, "made.tif").read();
  EXPECT_EQ(frame.width_px(), kWidth);
  EXPECT_EQ(frame.height_px(), kHeight);
  EXPECT_EQ(frame.depth(), bits == 8 ? Depth::bits8 : Depth::bits16);
  EXPECT_EQ(values_of(frame), grey_of(maker));
}

INSTANTIATE_TEST_SUITE_P(All, TiffKinds,
                         testing::Combine(testing::Values(8, 16),
                                          testing::Values(PHOTOMETRIC_MINISBLACK,
                                                          PHOTOMETRIC_MINISWHITE, PHOTOMETRIC_RGB),
                                          testing::Values(COMPRESSION_NONE, COMPRESSION_LZW,
                                                          COMPRESSION_ADOBE_DEFLATE,
                                                          COMPRESSION_PACKBITS),
                                          testing::Values(0, 16), testing::Bool(),
                                          testing::Bool()));

TEST(Tiff, BigTiffIsRead) {
  TiffMaker maker{.width = kWidth, .height = kHeight, .bits = 16, .big_tiff = true};
  maker.values = noise(kPixels, 65535, 6);
  const std::string file = make_tiff(maker);
  EXPECT_EQ(values_of(PictureFile(file, "made.tif").read()), grey_of(maker));
}

TEST(Tiff, PaletteOfSixteenOrEightBitsBecomesLuma) {
  for (const int scale : {256, 1}) {  // old writers filled in 8-bit values
    TiffMaker maker{.width = kWidth, .height = kHeight, .photometric = PHOTOMETRIC_PALETTE};
    maker.values = noise(kPixels, 255, 7);
    const auto colours = noise(768, 255, 8);
    for (const auto colour : colours) {
      maker.palette.push_back(static_cast<std::uint16_t>(colour * scale));
    }
    const std::string file = make_tiff(maker);
    const auto got = values_of(PictureFile(file, "made.tif").read());
    for (std::size_t i = 0; i < kPixels; ++i) {
      const std::size_t index = maker.values[i];
      ASSERT_EQ(got[i], expected_luma(colours[index], colours[256 + index], colours[512 + index]));
    }
  }
}

TEST(Tiff, JpegInTiffIsReadAsRgb) {
  TiffMaker maker{.width = 32,
                  .height = 32,
                  .samples = 3,
                  .photometric = PHOTOMETRIC_RGB,
                  .compression = COMPRESSION_JPEG,
                  .rows_per_strip = 16};
  maker.values.assign(32 * 32 * 3, 100);
  const std::string file = make_tiff(maker);
  for (const auto value : values_of(PictureFile(file, "made.tif").read())) EXPECT_EQ(value, 100u);
}

TEST(Tiff, PagesAreReadInAnyOrder) {
  TiffMaker maker{.width = 8, .height = 6, .bits = 16, .pages = 300};
  maker.values = noise(8 * 6 * 300, 65535, 9);
  const std::string bytes = make_tiff(maker);
  PictureFile file(bytes, "stack.tif");
  ASSERT_EQ(file.page_count(), 300u);
  for (const std::size_t page : {299u, 0u, 150u, 151u, 150u, 1u}) {
    const auto got = values_of(file.read(page));
    const auto start = maker.values.begin() + static_cast<std::ptrdiff_t>(page * 48);
    EXPECT_EQ(got, std::vector<std::uint32_t>(start, start + 48)) << page;
  }
  try {
    file.read(340);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::out_of_bounds);
    EXPECT_STREQ(error.what(), "stack.tif page 340: the file has 300 pages, 0 to 299");
  }
}

TEST(Tiff, WhatIsNoPictureOfGreysIsRefusedWithAdvice) {
  TiffMaker maker{.width = 8, .height = 8, .bits = 16, .sample_format = SAMPLEFORMAT_IEEEFP};
  maker.values.assign(64, 0);
  EXPECT_NE(error_of(maker).find("16-bit floating point; save it as"), std::string::npos);
  maker.sample_format = SAMPLEFORMAT_COMPLEXINT;
  EXPECT_NE(error_of(maker).find("complex numbers"), std::string::npos);
  maker.sample_format = SAMPLEFORMAT_UINT;
  maker.samples = 4;
  maker.photometric = PHOTOMETRIC_SEPARATED;
  maker.values.assign(64 * 4, 0);
  EXPECT_NE(error_of(maker).find("colours of kind 5"), std::string::npos);
}

TEST(Tiff, OnePageThatIsNotReadDoesNotSpoilTheOthers) {
  // Two 8 x 8 pages by hand: the second is of 32 bits.
  std::string file("II\x2a\0\x08\0\0\0", 8);
  const auto put = [&file](std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) file += static_cast<char>(value >> (8 * i));
  };
  const auto directory = [&](std::uint32_t bits, std::uint32_t next) {
    put(7, 2);
    const std::pair<std::uint32_t, std::uint32_t> fields[] = {
        {256, 8}, {257, 8}, {258, bits}, {259, 1}, {262, 1}, {273, 300}, {279, 8 * bits}};
    for (const auto& [tag, value] : fields) {
      put(tag, 2);
      put(4, 2);
      put(1, 4);
      put(value, 4);
    }
    put(next, 4);
  };
  directory(8, 8 + 90);
  directory(32, 0);
  file.resize(300 + 256, '\x07');
  PictureFile pages(file, "two.tif");
  EXPECT_EQ(pages.page_count(), 2u);
  EXPECT_THROW(pages.read(1), Error);
  EXPECT_EQ(pages.read(0).at(7, 7), 7u);
  // The second directory's link back to the first must not be walked forever.
  file[8 + 90 + 86] = 8;
  PictureFile loop(file, "loop.tif");
  EXPECT_EQ(loop.page_count(), 3u) << "two, and one that cannot be read";
  EXPECT_THROW(loop.read(2), Error);
}

}  // namespace
}  // namespace fathom::test
