// SPDX-License-Identifier: Apache-2.0
// JPEG writing by libjpeg-turbo, into memory.
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <string>
// jpeglib.h needs FILE and size_t before it.
#include <jpeglib.h>

#include "engine/error.hpp"
#include "pictures/raster.hpp"

namespace fathom {
namespace {

/// libjpeg's own state, and where its bytes go; freed whatever happens.
struct JpegWriter {
  jpeg_compress_struct codec{};
  jpeg_error_mgr errors{};
  std::jmp_buf way_back{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;

  ~JpegWriter() {
    jpeg_destroy_compress(&codec);
    std::free(bytes);
  }
};

[[noreturn]] void on_error(j_common_ptr codec) {
  std::longjmp(static_cast<JpegWriter*>(codec->client_data)->way_back, 1);
}

/// No object that needs a destructor lives here: an error jumps out of it.
bool write_rows(JpegWriter& writer, const Raster& raster, int quality) {
  if (setjmp(writer.way_back) != 0) return false;
  jpeg_compress_struct& codec = writer.codec;
  jpeg_create_compress(&codec);
  jpeg_mem_dest(&codec, &writer.bytes, &writer.size);
  codec.image_width = static_cast<JDIMENSION>(raster.width_px);
  codec.image_height = static_cast<JDIMENSION>(raster.height_px);
  codec.input_components = raster.channels;
  codec.in_color_space = raster.channels == 3 ? JCS_RGB : JCS_GRAYSCALE;
  jpeg_set_defaults(&codec);
  jpeg_set_quality(&codec, quality, TRUE);
  jpeg_start_compress(&codec, TRUE);
  while (codec.next_scanline < codec.image_height) {
    const std::byte* const bytes = raster.row(static_cast<int>(codec.next_scanline));
    JSAMPROW row = const_cast<JSAMPROW>(reinterpret_cast<const JSAMPLE*>(bytes));
    jpeg_write_scanlines(&codec, &row, 1);
  }
  jpeg_finish_compress(&codec);
  return true;
}

}  // namespace

std::string encode_jpeg(const Raster& raster, int quality) {
  if (raster.sample != Raster::Sample::uint8)
    throw Error(ErrorCode::bad_argument, "a JPEG holds 8 bits a sample");
  JpegWriter writer;
  writer.codec.err = jpeg_std_error(&writer.errors);
  writer.codec.client_data = &writer;
  writer.errors.error_exit = on_error;
  writer.errors.output_message = [](j_common_ptr) {};
  if (!write_rows(writer, raster, quality))
    throw Error(ErrorCode::out_of_memory, "cannot make a JPEG: not enough memory");
  return std::string(reinterpret_cast<const char*>(writer.bytes), writer.size);
}

}  // namespace fathom
