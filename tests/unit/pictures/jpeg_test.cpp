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

/// The file with an EXIF segment that tells this orientation.
std::string turned(const std::string& jpeg, int orientation, bool big_endian) {
  const std::string number = big_endian ? std::string{0, char(orientation), 0, 0}
                                        : std::string{char(orientation), 0, 0, 0};
  using namespace std::string_literals;
  const std::string exif = "Exif\0\0"s +
                           (big_endian ? "MM\0*\0\0\0\x08\0\1\x01\x12\0\3\0\0\0\1"s
                                       : "II*\0\x08\0\0\0\1\0\x12\x01\3\0\1\0\0\0"s) +
                           number + "\0\0\0\0"s;
  const auto size = static_cast<char>(exif.size() + 2);
  return jpeg.substr(0, 2) + "\xff\xe1\0"s + size + exif + jpeg.substr(2);
}

TEST(Jpeg, APictureThatIsStoredTurnedIsSeenUpright) {
  constexpr int kWidth = 32, kHeight = 16;
  // Bright in the stored upper left corner, grey in the upper right one.
  JpegMaker maker{.width = kWidth, .height = kHeight, .channels = 1};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x)
      maker.samples.push_back(y >= 8 ? 0 : x < 8 ? 250 : x >= 24 ? 120 : 0);
  }
  const std::string stored = make_jpeg(maker);
  struct Case {
    int orientation;
    bool first_is_right, first_is_low, second_is_right, second_is_low;
  };
  // Where EXIF 2.32 (table of tag 274) puts the two corners.
  for (const Case& one : {Case{1, false, false, true, false}, Case{2, true, false, false, false},
                          Case{3, true, true, false, true}, Case{4, false, true, true, true},
                          Case{5, false, false, false, true}, Case{6, true, false, true, true},
                          Case{7, true, true, true, false}, Case{8, false, true, false, false}}) {
    for (const bool big_endian : {false, true}) {
      const std::string bytes = turned(stored, one.orientation, big_endian);
      PictureFile file(bytes, "turned.jpg");
      const Frame frame = file.read();
      const bool on_side = one.orientation >= 5;
      EXPECT_EQ(frame.width_px(), on_side ? kHeight : kWidth);
      EXPECT_EQ(file.shape().width_px, frame.width_px());
      const auto corner = [&](bool right, bool low) {
        return static_cast<double>(
            frame.at(right ? frame.width_px() - 3 : 2, low ? frame.height_px() - 3 : 2));
      };
      EXPECT_NEAR(corner(one.first_is_right, one.first_is_low), 250, 6) << one.orientation;
      EXPECT_NEAR(corner(one.second_is_right, one.second_is_low), 120, 6) << one.orientation;
    }
  }
  // What says nothing sensible changes nothing.
  const std::string nonsense = turned(stored, 9, false);
  EXPECT_EQ(PictureFile(nonsense, "odd.jpg").read().width_px(), kWidth);
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
