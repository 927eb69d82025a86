// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>
// jpeglib.h needs FILE and size_t before it.
#include <jpeglib.h>

#include "engine/error.hpp"
#include "make_pictures.hpp"
#include "pictures/picture.hpp"

namespace fathom::test {
namespace {

std::vector<std::uint8_t> smooth(int width, int height, int channels) {
  std::vector<std::uint8_t> samples;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        samples.push_back(static_cast<std::uint8_t>((x * 5 + y * 3 + c * 70) % 256));
      }
    }
  }
  return samples;
}

/// What libjpeg itself decodes, as interleaved RGB: the formula of the luma is tested against that.
std::vector<std::uint8_t> decode_rgb(const std::string& file) {
  jpeg_decompress_struct codec{};
  jpeg_error_mgr errors{};
  codec.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&codec);
  jpeg_mem_src(&codec, reinterpret_cast<const unsigned char*>(file.data()), file.size());
  jpeg_read_header(&codec, TRUE);
  codec.out_color_space = JCS_RGB;
  jpeg_start_decompress(&codec);
  std::vector<std::uint8_t> samples(std::size_t{3} * codec.output_width * codec.output_height);
  while (codec.output_scanline < codec.output_height) {
    JSAMPROW row = samples.data() + std::size_t{3} * codec.output_width * codec.output_scanline;
    jpeg_read_scanlines(&codec, &row, 1);
  }
  jpeg_finish_decompress(&codec);
  jpeg_destroy_decompress(&codec);
  return samples;
}

TEST(Jpeg, ColourIsTheRoundedLumaOfTheDecodedRgb) {
  for (const bool progressive : {false, true}) {
    const std::string file = make_jpeg({.width = 37,
                                        .height = 29,
                                        .channels = 3,
                                        .progressive = progressive,
                                        .samples = smooth(37, 29, 3)});
    const Frame frame = PictureFile(file, "made.jpg").read();
    ASSERT_EQ(frame.width_px(), 37);
    ASSERT_EQ(frame.height_px(), 29);
    const auto rgb = decode_rgb(file);
    std::vector<std::uint32_t> wanted;
    for (std::size_t i = 0; i < rgb.size(); i += 3) {
      wanted.push_back(expected_luma(rgb[i], rgb[i + 1], rgb[i + 2]));
    }
    EXPECT_EQ(values_of(frame), wanted);
  }
}

TEST(Jpeg, GreyIsReadAsItIs) {
  const auto samples = smooth(40, 24, 1);
  const std::string file =
      make_jpeg({.width = 40, .height = 24, .channels = 1, .samples = samples});
  const Frame frame = PictureFile(file, "made.jpg").read();
  const auto rgb = decode_rgb(file);  // three equal values
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 40; ++x) {
      EXPECT_EQ(frame.at(x, y), rgb[static_cast<std::size_t>(3 * (y * 40 + x))]);
    }
  }
}

TEST(Jpeg, CmykIsRefusedWithAdvice) {
  const std::string file =
      make_jpeg({.width = 16, .height = 16, .channels = 4, .samples = smooth(16, 16, 4)});
  try {
    PictureFile(file, "print.jpg").read();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_data);
    EXPECT_NE(std::string(error.what()).find("print.jpg is a CMYK picture"), std::string::npos)
        << error.what();
  }
}

TEST(Jpeg, TruncatedIsAnErrorWhereverItEnds) {
  for (const bool progressive : {false, true}) {
    const std::string file = make_jpeg({.width = 64,
                                        .height = 48,
                                        .channels = 3,
                                        .progressive = progressive,
                                        .samples = smooth(64, 48, 3)});
    for (std::size_t size = 1; size < file.size(); ++size) {
      EXPECT_THROW(PictureFile(std::string_view(file).substr(0, size), "cut.jpg").read(), Error)
          << size << " of " << file.size() << " bytes were read as a whole picture";
    }
  }
}

TEST(Jpeg, ScanCutShortBeforeItsEndMarkerIsAnError) {
  std::string file =
      make_jpeg({.width = 64, .height = 48, .channels = 1, .samples = smooth(64, 48, 1)});
  file.replace(file.size() - 40, 38, "");  // the end marker stays
  EXPECT_THROW(PictureFile(file, "cut.jpg").read(), Error);
}

}  // namespace
}  // namespace fathom::test
