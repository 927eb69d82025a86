// SPDX-License-Identifier: Apache-2.0
// Colours that are read beside the greys, and pictures of every kind that are written.
#include <gtest/gtest.h>
#include <png.h>
#include <tiffio.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "pictures/picture.hpp"
#include "pictures/raster.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/pictures/make_pictures.hpp"

namespace fathom::test {
namespace {

constexpr int kWidth = 13, kHeight = 7;
constexpr std::size_t kSamples = 3 * kWidth * kHeight;

/// What a file gives: its greys, and its colours as wide numbers.
struct Read {
  Frame grey;
  Colours colours;
  std::vector<std::uint16_t> samples() const {
    if (!colours.bits16.empty()) return colours.bits16;
    return {colours.bits8.begin(), colours.bits8.end()};
  }
};

Read read_both(const std::string& bytes) {
  Read result;
  result.grey = PictureFile(bytes, "test").read(0, result.colours);
  return result;
}

/// The greys must be those that a reading without colours gives, and the luma of the colours.
void expect_lossless(const std::string& bytes, const std::vector<std::uint16_t>& colours) {
  const Read both = read_both(bytes);
  EXPECT_EQ(both.samples(), colours);
  EXPECT_EQ(values_of(both.grey), values_of(PictureFile(bytes, "test").read()));
  for (std::size_t i = 0; i < colours.size() / 3; ++i) {
    EXPECT_EQ(values_of(both.grey)[i],
              expected_luma(colours[3 * i], colours[3 * i + 1], colours[3 * i + 2]));
  }
}

std::string ppm(const std::vector<std::uint16_t>& samples, int largest) {
  std::string text = "P6\n13 7\n" + std::to_string(largest) + "\n";
  for (const std::uint16_t sample : samples) {
    if (largest > 255) text.push_back(static_cast<char>(sample >> 8));
    text.push_back(static_cast<char>(sample & 0xff));
  }
  return text;
}

TEST(Colours, EveryFormatKeepsThemAsTheyAre) {
  const auto narrow = noise(kSamples, 255, 1), wide = noise(kSamples, 65535, 2);
  expect_lossless(ppm(narrow, 255), narrow);
  expect_lossless(ppm(wide, 65535), wide);
  for (const bool planes : {false, true}) {
    for (const int tile : {0, 16}) {
      TiffMaker tiff{.width = kWidth, .height = kHeight, .samples = 3, .photometric = 2};
      tiff.tile = tile;
      tiff.separate_planes = planes;
      tiff.values = narrow;
      expect_lossless(make_tiff(tiff), narrow);
      tiff.bits = 16;
      tiff.values = wide;
      expect_lossless(make_tiff(tiff), wide);
    }
  }
  PngMaker png{.width = kWidth, .height = kHeight, .colour_type = PNG_COLOR_TYPE_RGB};
  png.packed_rows.assign(narrow.begin(), narrow.end());
  for (const bool interlaced : {false, true}) {
    png.interlaced = interlaced;
    expect_lossless(make_png(png), narrow);
  }
}

TEST(Colours, APaletteGivesThoseThatItNames) {
  TiffMaker tiff{.width = 2, .height = 1, .photometric = 3};
  tiff.values = {3, 200};
  tiff.palette.assign(3 * 256, 0);
  tiff.palette[3] = 0xff00, tiff.palette[256 + 3] = 0x1200, tiff.palette[512 + 200] = 0x8000;
  EXPECT_EQ(read_both(make_tiff(tiff)).samples(),
            (std::vector<std::uint16_t>{0xff, 0x12, 0, 0, 0, 0x80}));
}

TEST(Colours, GreyHasNone) {
  TiffMaker tiff{.width = kWidth, .height = kHeight};
  tiff.values = noise(kWidth * kHeight, 255, 3);
  EXPECT_TRUE(read_both(make_tiff(tiff)).colours.empty());
  Colours old{.bits8 = {1, 2, 3}, .bits16 = {}};
  PictureFile(make_tiff(tiff), "test").read(0, old);
  EXPECT_TRUE(old.empty());
}

TEST(Colours, WhatIsWrittenIsReadBack) {
  const TemporaryFolder folder;
  const auto narrow = noise(kSamples, 255, 4), wide = noise(kSamples, 65535, 5);
  for (const char* name : {"a.png", "a.tif"}) {
    for (const bool is_wide : {false, true}) {
      const Read made = read_both(is_wide ? ppm(wide, 65535) : ppm(narrow, 255));
      write_picture(folder.path() / name, made.grey, made.colours);
      const Read back = read_both(read_file(folder.path() / name));
      EXPECT_EQ(back.samples(), made.samples()) << name;
    }
  }
}

TEST(Colours, OfAnotherSizeAreRefused) {
  const TemporaryFolder folder;
  const Frame grey = noise_frame(4, 4, Depth::bits8, 1);
  const Colours colours{.bits8 = std::vector<std::uint8_t>(3 * 4 * 3), .bits16 = {}};
  EXPECT_THROW(write_picture(folder.path() / "a.png", grey, colours), Error);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.png"));
}

TEST(Raster, FloatsAndTheirDescriptionAreWhatLibtiffReads) {
  const TemporaryFolder folder;
  const std::vector<float> values = {1.5F, -2.25e-6F, std::numeric_limits<float>::quiet_NaN(),
                                     3e9F, 0,         7};
  Raster raster = raster_of(values.data(), 3, 2);
  raster.description = "<OME/>";
  const std::string path = (folder.path() / "f.tif").string();
  write_file(path, encode_tiff(raster));
  TIFF* const tiff = TIFFOpen(path.c_str(), "r");
  ASSERT_NE(tiff, nullptr);
  char* description = nullptr;
  std::uint16_t format = 0;
  TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &description);
  TIFFGetField(tiff, TIFFTAG_SAMPLEFORMAT, &format);
  EXPECT_STREQ(description, "<OME/>");
  EXPECT_EQ(format, SAMPLEFORMAT_IEEEFP);
  std::vector<float> back(6);
  TIFFReadEncodedStrip(tiff, 0, back.data(), 24);
  TIFFClose(tiff);
  EXPECT_TRUE(std::isnan(back[2]));
  back[2] = 0;
  EXPECT_EQ(back, (std::vector<float>{1.5F, -2.25e-6F, 0, 3e9F, 0, 7}));
}

TEST(Raster, APaletteIsWrittenAsItsColours) {
  const std::vector<std::uint8_t> values = {0, 1, 1, 0};
  const std::vector<std::array<std::uint8_t, 3>> palette = {{1, 2, 3}, {250, 0, 9}};
  Raster raster = raster_of(values.data(), 2, 2);
  raster.palette = palette;
  for (const PngEffort effort : {PngEffort::small, PngEffort::fast}) {
    EXPECT_EQ(read_both(encode_png(raster, effort)).samples(),
              (std::vector<std::uint16_t>{1, 2, 3, 250, 0, 9, 250, 0, 9, 1, 2, 3}));
  }
}

TEST(Raster, AJpegIsNearWhatWentIn) {
  std::vector<std::uint8_t> ramp(3 * 64 * 16);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<std::uint8_t>(i / 3 % 64 * 4);
  Raster raster = raster_of(ramp.data(), 64, 16);
  raster.channels = 3;
  const auto back = read_both(encode_jpeg(raster, 95)).samples();
  ASSERT_EQ(back.size(), ramp.size());
  for (std::size_t i = 0; i < ramp.size(); ++i) EXPECT_NEAR(back[i], ramp[i], 6);
  const std::vector<float> floats(4);
  EXPECT_THROW(encode_jpeg(raster_of(floats.data(), 2, 2), 90), Error);
  EXPECT_THROW(encode_png(raster_of(floats.data(), 2, 2), PngEffort::fast), Error);
}

}  // namespace
}  // namespace fathom::test
