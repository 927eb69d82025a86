// SPDX-License-Identifier: Apache-2.0
#include "pixel_format.hpp"

#include <stdio.h>  // Before jpeglib.h, which needs FILE.

#include <jpeglib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

namespace fathom::usb {

namespace {

using Levels = std::vector<std::uint16_t>;  ///< 16-bit grey levels, [y][x].

// Twelve uniform numbers make a good normal one (Irwin and Hall).
const std::vector<int>& unit_noise() {
  static const std::vector<int> table = [] {
    std::mt19937 random(12345);
    std::vector<int> values(1 << 16);
    for (int& value : values) {
      for (int i = 0; i < 12; ++i) value += static_cast<int>(random() >> 20) - 2048;
    }
    return values;  // Standard deviation 4096.
  }();
  return table;
}

Levels develop(const Picture& picture, const Development& development) {
  Levels levels(picture.pixels.size());
  const auto gain = std::llround(development.gain * 65536);
  const auto noise = std::llround(development.noise * 256 * 16);  // In 1/4096 of its table.
  const std::vector<int>& table = unit_noise();
  std::size_t at = development.noise_seed % table.size();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    std::int64_t value = (picture.pixels[i] * gain >> 16) + development.offset;
    if (noise != 0) {
      value += table[at] * noise >> 16;
      at = (at + 1) & (table.size() - 1);
    }
    levels[i] = static_cast<std::uint16_t>(std::clamp<std::int64_t>(value, 0, 65535));
  }
  return levels;
}

Bytes grey(const Levels& levels) {
  Bytes bytes(levels.size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(levels[i] >> 8);
  }
  return bytes;
}

Bytes deep(const Levels& levels, int bits) {
  Bytes bytes(levels.size() * 2);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const int level = levels[i] >> (16 - bits);
    bytes[2 * i] = static_cast<std::uint8_t>(level);
    bytes[2 * i + 1] = static_cast<std::uint8_t>(level >> 8);
  }
  return bytes;
}

std::uint8_t chroma(int offset) {
  return static_cast<std::uint8_t>(std::clamp(128 + offset, 0, 255));
}

Bytes yuyv(const Levels& levels, int blueness) {
  Bytes bytes(levels.size() * 2);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    bytes[2 * i] = static_cast<std::uint8_t>(levels[i] >> 8);
    bytes[2 * i + 1] = chroma(i % 2 == 0 ? blueness : -blueness);
  }
  return bytes;
}

Bytes nv12(const Levels& levels, int blueness) {
  Bytes bytes = grey(levels);
  for (std::size_t i = 0; i < levels.size() / 4; ++i) {
    bytes.push_back(chroma(blueness));
    bytes.push_back(chroma(-blueness));
  }
  return bytes;
}

// As webcams do it: colour, half of it, quality good.
Bytes jpeg(const Levels& levels, int width_px, int height_px, int blueness) {
  jpeg_compress_struct compressor;
  jpeg_error_mgr errors;
  compressor.err = jpeg_std_error(&errors);
  jpeg_create_compress(&compressor);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&compressor, &buffer, &size);
  compressor.image_width = static_cast<JDIMENSION>(width_px);
  compressor.image_height = static_cast<JDIMENSION>(height_px);
  compressor.input_components = 3;
  compressor.in_color_space = JCS_YCbCr;
  jpeg_set_defaults(&compressor);
  jpeg_set_quality(&compressor, 92, TRUE);
  compressor.comp_info[0].v_samp_factor = 1;  // 4:2:2.
  jpeg_start_compress(&compressor, TRUE);
  std::vector<JSAMPLE> row(static_cast<std::size_t>(width_px) * 3);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      JSAMPLE* pixel = &row[static_cast<std::size_t>(x) * 3];
      pixel[0] = static_cast<JSAMPLE>(levels[static_cast<std::size_t>(y * width_px + x)] >> 8);
      pixel[1] = chroma(blueness);
      pixel[2] = chroma(-blueness);
    }
    JSAMPROW rows[] = {row.data()};
    jpeg_write_scanlines(&compressor, rows, 1);
  }
  jpeg_finish_compress(&compressor);
  jpeg_destroy_compress(&compressor);
  Bytes bytes(buffer, buffer + size);
  std::free(buffer);
  return bytes;
}

}  // namespace

const std::vector<PixelFormat>& pixel_formats() {
  static const std::vector<PixelFormat> table = {
      {"GREY", {'Y', '8', '0', '0'}, 8},  {"YUYV", {'Y', 'U', 'Y', '2'}, 16},
      {"NV12", {'N', 'V', '1', '2'}, 12}, {"MJPG", {'M', 'J', 'P', 'G'}, 0},
      {"Y10", {'Y', '1', '0', ' '}, 16},  {"Y12", {'Y', '1', '2', ' '}, 16},
      {"Y16", {'Y', '1', '6', ' '}, 16},
  };
  return table;
}

Bytes encode(const PixelFormat& format, const Picture& picture, const Development& development) {
  const Levels levels = develop(picture, development);
  const std::string name = format.name;
  if (name == "YUYV") return yuyv(levels, development.blueness);
  if (name == "NV12") return nv12(levels, development.blueness);
  if (name == "MJPG") {
    return jpeg(levels, picture.width_px, picture.height_px, development.blueness);
  }
  if (name == "Y10") return deep(levels, 10);
  if (name == "Y12") return deep(levels, 12);
  if (name == "Y16") return deep(levels, 16);
  return grey(levels);
}

}  // namespace fathom::usb
