// SPDX-License-Identifier: Apache-2.0
#include "make_pictures.hpp"

#include <png.h>
#include <tiffio.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <stdexcept>
// jpeglib.h needs FILE and size_t before it.
#include <jpeglib.h>

#include "engine/file.hpp"

namespace fathom::test {
namespace fs = std::filesystem;

std::string make_png(const PngMaker& maker) {
  std::string file;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &file,
      [](png_structp writer, png_bytep bytes, std::size_t count) {
        static_cast<std::string*>(png_get_io_ptr(writer))
            ->append(reinterpret_cast<char*>(bytes), count);
      },
      nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(maker.width),
               static_cast<png_uint_32>(maker.height), maker.bit_depth, maker.colour_type,
               maker.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  std::vector<png_color> palette;
  for (std::size_t i = 0; i + 2 < maker.palette.size(); i += 3) {
    palette.push_back({maker.palette[i], maker.palette[i + 1], maker.palette[i + 2]});
  }
  if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  if (!maker.transparency.empty()) {
    png_set_tRNS(png, info, maker.transparency.data(), static_cast<int>(maker.transparency.size()),
                 nullptr);
  }
  png_write_info(png, info);
  std::vector<std::uint8_t> bytes = maker.packed_rows;
  const std::size_t row_bytes = bytes.size() / static_cast<std::size_t>(maker.height);
  std::vector<png_bytep> rows;
  for (int y = 0; y < maker.height; ++y) rows.push_back(bytes.data() + y * row_bytes);
  png_write_image(png, rows.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return file;
}

std::string make_jpeg(const JpegMaker& maker) {
  jpeg_compress_struct codec{};
  jpeg_error_mgr errors{};
  codec.err = jpeg_std_error(&errors);
  jpeg_create_compress(&codec);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&codec, &buffer, &size);
  codec.image_width = static_cast<JDIMENSION>(maker.width);
  codec.image_height = static_cast<JDIMENSION>(maker.height);
  codec.input_components = maker.channels;
  codec.in_color_space = maker.channels == 1   ? JCS_GRAYSCALE
                         : maker.channels == 3 ? JCS_RGB
                                               : JCS_CMYK;
  jpeg_set_defaults(&codec);
  jpeg_set_quality(&codec, 95, TRUE);
  if (maker.progressive) jpeg_simple_progression(&codec);
  jpeg_start_compress(&codec, TRUE);
  std::vector<std::uint8_t> samples = maker.samples;
  while (codec.next_scanline < codec.image_height) {
    JSAMPROW row = samples.data() + codec.next_scanline * static_cast<std::size_t>(maker.width) *
                                        static_cast<std::size_t>(maker.channels);
    jpeg_write_scanlines(&codec, &row, 1);
  }
  jpeg_finish_compress(&codec);
  std::string file(reinterpret_cast<char*>(buffer), size);
  std::free(buffer);
  jpeg_destroy_compress(&codec);
  return file;
}

namespace {

/// Values of a rectangle of a page as bytes in native order; beyond the page's edge, zeros.
std::vector<std::uint8_t> chunk_bytes(const TiffMaker& maker, int page, int left, int top,
                                      int columns, int rows, int plane) {
  std::vector<std::uint8_t> bytes;
  const int first = plane < 0 ? 0 : plane;
  const int last = plane < 0 ? maker.samples - 1 : plane;
  for (int y = top; y < top + rows; ++y) {
    for (int x = left; x < left + columns; ++x) {
      for (int s = first; s <= last; ++s) {
        const bool inside = x < maker.width && y < maker.height;
        const auto at = static_cast<std::size_t>(
            ((page * maker.height + y) * maker.width + x) * maker.samples + s);
        const std::uint16_t value = inside ? maker.values.at(at) : std::uint16_t{0};
        bytes.push_back(static_cast<std::uint8_t>(value & 0xff));
        if (maker.bits == 16) bytes.push_back(static_cast<std::uint8_t>(value >> 8));
        if (maker.bits == 32) bytes.insert(bytes.end(), 3, 0);
      }
    }
  }
  return bytes;
}

void write_chunks(TIFF* tiff, const TiffMaker& maker, int page) {
  const int step_x = maker.tile > 0 ? maker.tile : maker.width;
  const int step_y = maker.tile > 0 ? maker.tile : maker.rows_per_strip;
  for (int plane = 0; plane < (maker.separate_planes ? maker.samples : 1); ++plane) {
    for (int top = 0; top < maker.height; top += step_y) {
      for (int left = 0; left < maker.width; left += step_x) {
        const int rows = maker.tile > 0 ? step_y : std::min(step_y, maker.height - top);
        auto bytes =
            chunk_bytes(maker, page, left, top, step_x, rows, maker.separate_planes ? plane : -1);
        const auto size = static_cast<tmsize_t>(bytes.size());
        const auto x = static_cast<std::uint32_t>(left);
        const auto y = static_cast<std::uint32_t>(top);
        const auto p = static_cast<std::uint16_t>(plane);
        if (maker.tile > 0) {
          TIFFWriteEncodedTile(tiff, TIFFComputeTile(tiff, x, y, 0, p), bytes.data(), size);
        } else {
          TIFFWriteEncodedStrip(tiff, TIFFComputeStrip(tiff, y, p), bytes.data(), size);
        }
      }
    }
  }
}

}  // namespace

std::string make_tiff(const TiffMaker& maker) {
  const TemporaryFolder folder;
  const fs::path path = folder / "made.tif";
  std::string mode = maker.big_endian ? "wb" : "wl";
  if (maker.big_tiff) mode += '8';
  TIFF* tiff = TIFFOpen(path.c_str(), mode.c_str());
  if (tiff == nullptr) throw std::runtime_error("libtiff cannot write");
  for (int page = 0; page < maker.pages; ++page) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, maker.width);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, maker.height);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, maker.bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, maker.samples);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, maker.sample_format);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, maker.photometric);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, maker.compression);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG,
                 maker.separate_planes ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
    if (maker.tile > 0) {
      TIFFSetField(tiff, TIFFTAG_TILEWIDTH, maker.tile);
      TIFFSetField(tiff, TIFFTAG_TILELENGTH, maker.tile);
    } else {
      TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, maker.rows_per_strip);
    }
    if (page == 0 && !maker.description.empty())
      TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, maker.description.c_str());
    if (!maker.palette.empty()) {
      TIFFSetField(tiff, TIFFTAG_COLORMAP, maker.palette.data(), maker.palette.data() + 256,
                   maker.palette.data() + 512);
    }
    write_chunks(tiff, maker, page);
    TIFFWriteDirectory(tiff);
  }
  TIFFClose(tiff);
  return read_file(path);
}

std::vector<std::uint16_t> noise(std::size_t count, std::uint32_t largest, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::uint16_t> values(count);
  for (auto& value : values) value = static_cast<std::uint16_t>(random() % (largest + 1));
  return values;
}

Frame noise_frame(int width, int height, Depth depth, std::uint32_t seed) {
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (depth == Depth::bits16) return Frame(width, height, noise(count, 65535, seed));
  const auto values = noise(count, 255, seed);
  std::vector<std::uint8_t> bytes;
  for (const auto value : values) bytes.push_back(static_cast<std::uint8_t>(value));
  return Frame(width, height, std::move(bytes));
}

std::vector<std::uint32_t> values_of(const Frame& frame) {
  std::vector<std::uint32_t> values;
  for (int y = 0; y < frame.height_px(); ++y) {
    for (int x = 0; x < frame.width_px(); ++x) values.push_back(frame.at(x, y));
  }
  return values;
}

std::uint32_t expected_luma(double red, double green, double blue) {
  // Thousandths are exact in a double; a half can only come from them, and rounds up.
  return static_cast<std::uint32_t>(
      std::floor((299 * red + 587 * green + 114 * blue + 500) / 1000));
}

}  // namespace fathom::test
