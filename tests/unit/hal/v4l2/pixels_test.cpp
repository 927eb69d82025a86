// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/pixels.hpp"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <cstdio>
#include <cstdlib>
#include <vector>
// jpeglib.h needs FILE and size_t before it.
#include <jpeglib.h>

#include "tests/support/patterns.hpp"

namespace fathom::test {
namespace {

using v4l2::Layout;
using Bytes = std::vector<std::uint8_t>;

const v4l2::PixelFormat& format_of(std::uint32_t fourcc) {
  return *v4l2::find_pixel_format(fourcc);
}

Bytes noise(std::size_t size) {
  SplitMix64 random(7);
  Bytes bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
  return bytes;
}

/// A grey JPEG of flat brightness.
Bytes jpeg_of(int width, int height, std::uint8_t grey) {
  jpeg_compress_struct codec{};
  jpeg_error_mgr errors{};
  codec.err = jpeg_std_error(&errors);
  jpeg_create_compress(&codec);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&codec, &memory, &size);
  codec.image_width = static_cast<JDIMENSION>(width);
  codec.image_height = static_cast<JDIMENSION>(height);
  codec.input_components = 1;
  codec.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&codec);
  jpeg_start_compress(&codec, TRUE);
  Bytes line(static_cast<std::size_t>(width), grey);
  for (int y = 0; y < height; ++y) {
    JSAMPROW row = line.data();
    jpeg_write_scanlines(&codec, &row, 1);
  }
  jpeg_finish_compress(&codec);
  Bytes bytes(memory, memory + size);
  jpeg_destroy_compress(&codec);
  std::free(memory);
  return bytes;
}

struct Case {
  std::uint32_t fourcc;
  /// Where the low byte of a pixel's luma is in its row, and how many bytes it has.
  int pixel_bytes, luma_bytes;
};

TEST(Pixels, EveryFormatGivesItsLumaWhateverTheStride) {
  constexpr Case kCases[] = {{V4L2_PIX_FMT_GREY, 1, 1}, {V4L2_PIX_FMT_Y10, 2, 2},
                             {V4L2_PIX_FMT_Y12, 2, 2},  {V4L2_PIX_FMT_Y16, 2, 2},
                             {V4L2_PIX_FMT_YUYV, 2, 1}, {V4L2_PIX_FMT_NV12, 1, 1}};
  for (const Case& format : kCases) {
    for (const int width : {1, 2, 7, 32}) {
      for (const std::size_t gap : {0, 1, 13}) {
        const Layout layout{width, 5, v4l2::row_bytes(format_of(format.fourcc), width) + gap};
        const Bytes bytes = noise(layout.stride_bytes * 8);
        const auto frame = v4l2::to_grey(format_of(format.fourcc), layout, bytes);
        ASSERT_TRUE(frame);
        ASSERT_EQ(frame->width_px(), width);
        ASSERT_EQ(frame->height_px(), 5);
        ASSERT_EQ(frame->depth(), format.luma_bytes == 2 ? Depth::bits16 : Depth::bits8);
        for (int y = 0; y < 5; ++y) {
          for (int x = 0; x < width; ++x) {
            const std::size_t at = y * layout.stride_bytes + x * format.pixel_bytes;
            const unsigned high = format.luma_bytes == 2 ? bytes[at + 1] : 0;
            ASSERT_EQ(frame->at(x, y), bytes[at] + 256 * high) << x << ", " << y;
          }
        }
      }
    }
  }
}

TEST(Pixels, OneByteTooFewIsNoPicture) {
  for (const v4l2::PixelFormat& format : v4l2::pixel_formats()) {
    if (format.is_compressed) continue;
    const std::size_t row = v4l2::row_bytes(format, 6);
    const Layout layout{6, 4, row + 3};
    const std::size_t rows = format.fourcc == V4L2_PIX_FMT_NV12 ? 6 : 4;  // with colour
    const std::size_t whole = layout.stride_bytes * (rows - 1) + row;
    EXPECT_TRUE(v4l2::to_grey(format, layout, Bytes(whole))) << format.name;
    EXPECT_FALSE(v4l2::to_grey(format, layout, Bytes(whole - 1))) << format.name;
    EXPECT_FALSE(v4l2::to_grey(format, layout, {})) << format.name;
  }
}

TEST(Pixels, AJpegIsDecodedAndWhatFollowsItIsIgnored) {
  Bytes bytes = jpeg_of(24, 16, 130);
  bytes.resize(bytes.size() + 1000, 0);
  for (const std::uint32_t fourcc : {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_JPEG}) {
    const auto frame = v4l2::to_grey(format_of(fourcc), {24, 16, 0}, bytes);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->width_px(), 24);
    EXPECT_EQ(frame->at(11, 7), 130);
  }
}

TEST(Pixels, AJpegThatIsDamagedOrOfAnotherSizeIsNoPicture) {
  const auto& mjpeg = format_of(V4L2_PIX_FMT_MJPEG);
  const Bytes bytes = jpeg_of(24, 16, 130);
  EXPECT_FALSE(v4l2::to_grey(mjpeg, {24, 24, 0}, bytes));
  EXPECT_FALSE(v4l2::to_grey(mjpeg, {24, 16, 0}, {}));
  for (std::size_t size = 0; size + 2 < bytes.size(); size += 7) {
    EXPECT_FALSE(v4l2::to_grey(mjpeg, {24, 16, 0}, {bytes.data(), size})) << size;
  }
  Bytes scrambled = noise(2000);
  EXPECT_FALSE(v4l2::to_grey(mjpeg, {24, 16, 0}, scrambled));
  scrambled[0] = 'P', scrambled[1] = '5', scrambled[2] = '\n';  // another format than promised
  EXPECT_FALSE(v4l2::to_grey(mjpeg, {24, 16, 0}, scrambled));
}

/// Webcams leave out the usual Huffman tables, as Motion JPEG allows.
TEST(Pixels, AJpegWithoutItsHuffmanTablesIsDecoded) {
  const Bytes whole = jpeg_of(24, 16, 77);
  Bytes bytes;
  for (std::size_t i = 0; i < whole.size();) {
    const bool is_table = whole[i] == 0xff && i + 3 < whole.size() && whole[i + 1] == 0xc4;
    if (is_table) {
      i += 2 + whole[i + 2] * 256U + whole[i + 3];
    } else {
      bytes.push_back(whole[i++]);
    }
  }
  ASSERT_LT(bytes.size(), whole.size() - 200);
  const auto frame = v4l2::to_grey(format_of(V4L2_PIX_FMT_MJPEG), {24, 16, 0}, bytes);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->at(3, 3), 77);
}

}  // namespace
}  // namespace fathom::test
