// SPDX-License-Identifier: Apache-2.0
// TIFF writing by libtiff: one page, uncompressed, in one strip, which every program reads.
#include <tiffio.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

#include "engine/error.hpp"
#include "pictures/raster.hpp"

namespace fathom {
namespace {

/// A file in memory, which libtiff reads back, seeks in and grows.
struct MemoryFile {
  std::string bytes;
  std::size_t offset = 0;
};

MemoryFile& file_of(thandle_t handle) { return *static_cast<MemoryFile*>(handle); }

tmsize_t on_read(thandle_t handle, void* to, tmsize_t count) {
  MemoryFile& file = file_of(handle);
  if (file.offset >= file.bytes.size()) return 0;
  const std::size_t got =
      std::min(static_cast<std::size_t>(count), file.bytes.size() - file.offset);
  std::memcpy(to, file.bytes.data() + file.offset, got);
  file.offset += got;
  return static_cast<tmsize_t>(got);
}

tmsize_t on_write(thandle_t handle, void* from, tmsize_t count) try {
  MemoryFile& file = file_of(handle);
  const std::size_t end = file.offset + static_cast<std::size_t>(count);
  if (end > file.bytes.size()) file.bytes.resize(end);
  std::memcpy(file.bytes.data() + file.offset, from, static_cast<std::size_t>(count));
  file.offset = end;
  return count;
} catch (const std::bad_alloc&) {
  return -1;  // no exception may cross libtiff
}

toff_t on_seek(thandle_t handle, toff_t offset, int whence) {
  MemoryFile& file = file_of(handle);
  if (whence == SEEK_CUR) offset += file.offset;
  if (whence == SEEK_END) offset += file.bytes.size();
  return file.offset = offset;
}

toff_t on_size(thandle_t handle) { return file_of(handle).bytes.size(); }
int on_close(thandle_t) { return 0; }
int on_map(thandle_t, void**, toff_t*) { return 0; }
void on_unmap(thandle_t, void*, toff_t) {}
int on_message(TIFF*, void*, const char*, const char*, va_list) { return 1; }  // print nothing

int bits_of(Raster::Sample sample) {
  switch (sample) {
    case Raster::Sample::uint8:
      return 8;
    case Raster::Sample::uint16:
      return 16;
    case Raster::Sample::float32:
      return 32;
  }
  return 0;
}

bool write_page(TIFF* tiff, const Raster& raster) {
  const bool is_float = raster.sample == Raster::Sample::float32;
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, raster.width_px);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, raster.height_px);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits_of(raster.sample));
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, is_float ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, raster.channels);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC,
               raster.channels == 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, raster.height_px);
  if (!raster.description.empty())
    TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, raster.description.c_str());
  // The strip as it lies in memory, in the byte order of the file: nothing is copied twice.
  const auto bytes = static_cast<tmsize_t>(raster.row_bytes()) * raster.height_px;
  if (TIFFWriteRawStrip(tiff, 0, const_cast<void*>(raster.samples), bytes) != bytes) return false;
  return TIFFWriteDirectory(tiff) == 1;
}

}  // namespace

std::string encode_tiff(const Raster& raster) {
  const std::uint64_t pixel_bytes =
      std::uint64_t{raster.row_bytes()} * static_cast<std::uint64_t>(raster.height_px);
  constexpr std::uint64_t kDirectory = 1024;  // and more than enough for the header
  MemoryFile file;
  file.bytes.reserve(pixel_bytes + raster.description.size() + kDirectory);
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  if (options == nullptr) throw std::bad_alloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, on_message, nullptr);
  TIFFOpenOptionsSetWarningHandlerExtR(options, on_message, nullptr);
  const bool is_big = pixel_bytes > 0xf000'0000;  // classic TIFF counts in 32 bits
  TIFF* tiff = TIFFClientOpenExt("picture", is_big ? "w8" : "w", &file, on_read, on_write, on_seek,
                                 on_close, on_size, on_map, on_unmap, options);
  TIFFOpenOptionsFree(options);
  if (tiff == nullptr) throw std::bad_alloc();
  const bool written = write_page(tiff, raster);
  TIFFClose(tiff);
  if (!written) throw Error(ErrorCode::out_of_memory, "cannot make a TIFF: not enough memory");
  return std::move(file.bytes);
}

}  // namespace fathom
