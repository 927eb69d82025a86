// SPDX-License-Identifier: Apache-2.0
// PNG writing by libpng.
#include <zlib.h>

#include <bit>
#include <cstring>
#include <new>
#include <vector>

#include "engine/error.hpp"
#include "pictures/decoder.hpp"
#include "pictures/png_calls.hpp"
#include "pictures/raster.hpp"

namespace fathom {
namespace {

using pictures::guarded;
using pictures::PngTrouble;

void on_write(png_structp png, png_bytep bytes, std::size_t count) {
  bool out_of_memory = false;
  try {
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<char*>(bytes), count);
  } catch (const std::bad_alloc&) {
    out_of_memory = true;  // png_error must not jump out of a catch block
  }
  if (out_of_memory) png_error(png, "not enough memory");
}

int colour_type_of(const Raster& raster) {
  if (raster.channels == 3) return PNG_COLOR_TYPE_RGB;
  return raster.palette.empty() ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_PALETTE;
}

void set_effort(png_structp png, const Raster& raster, PngEffort effort) {
  switch (effort) {
    case PngEffort::small:
      return;
    case PngEffort::fast:
      // Numbers of a palette have no neighbours in value, so a difference says nothing.
      png_set_filter(png, PNG_FILTER_TYPE_BASE,
                     raster.palette.empty() ? PNG_FILTER_SUB : PNG_FILTER_NONE);
      png_set_compression_level(png, 1);
      png_set_compression_strategy(png, raster.palette.empty() ? Z_RLE : Z_DEFAULT_STRATEGY);
  }
}

void write_rows(png_structp png, png_infop info, const Raster& raster, PngEffort effort,
                std::vector<png_byte>& row, std::string& file) {
  png_set_write_fn(png, &file, on_write, nullptr);
  const int bits = raster.sample == Raster::Sample::uint16 ? 16 : 8;
  png_set_IHDR(png, info, static_cast<png_uint_32>(raster.width_px),
               static_cast<png_uint_32>(raster.height_px), bits, colour_type_of(raster),
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_color colours[256];
  for (std::size_t i = 0; i < raster.palette.size(); ++i)
    colours[i] = {raster.palette[i][0], raster.palette[i][1], raster.palette[i][2]};
  if (!raster.palette.empty())
    png_set_PLTE(png, info, colours, static_cast<int>(raster.palette.size()));
  set_effort(png, raster, effort);
  png_write_info(png, info);
  if constexpr (std::endian::native == std::endian::little) png_set_swap(png);
  for (int y = 0; y < raster.height_px; ++y) {
    std::memcpy(row.data(), raster.row(y), row.size());  // libpng swaps 16 bits in its own copy
    png_write_row(png, row.data());
  }
  png_write_end(png, nullptr);
}

}  // namespace

std::string encode_png(const Raster& raster, PngEffort effort) {
  if (raster.sample == Raster::Sample::float32 || raster.palette.size() > 256)
    throw Error(ErrorCode::bad_argument, "a PNG holds no floating point and 256 colours at most");
  PngTrouble trouble;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &trouble, pictures::on_png_error,
                                            pictures::on_png_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  std::string file;
  std::vector<png_byte> row(raster.row_bytes());
  const bool written =
      info != nullptr && guarded(png, [&] { write_rows(png, info, raster, effort, row, file); });
  png_destroy_write_struct(&png, &info);
  if (!written) {
    throw Error(ErrorCode::out_of_memory, std::string("cannot make a PNG: ") + trouble.message);
  }
  return file;
}

}  // namespace fathom
