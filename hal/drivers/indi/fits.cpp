// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/fits.hpp"

#include <fitsio.h>
#include <fmt/format.h>

#include <mutex>
#include <utility>
#include <vector>

#include "engine/error.hpp"

namespace fathom::indi {
namespace {

[[noreturn]] void refuse(ErrorCode code, const std::string& what) {
  throw Error(code, "a picture of the INDI camera " + what);
}

/// cfitsio keeps a table of open files and a stack of messages for the whole process.
std::mutex& cfitsio_lock() {
  static std::mutex lock;
  return lock;
}

/// FITS comes in blocks, and cfitsio 4.2 reads whole ones: beyond the end of memory that holds less
/// (a fuzzer found that).
constexpr std::size_t kBlock = 2880;

/// An open FITS file in memory.
class MemoryFile {
 public:
  explicit MemoryFile(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {
    bytes_.resize((bytes_.size() + kBlock - 1) / kBlock * kBlock);
    data_ = bytes_.data();
    size_ = bytes_.size();
    int status = 0;
    fits_open_memfile(&file_, "picture", READONLY, &data_, &size_, 0, nullptr, &status);
    require(status);
  }
  ~MemoryFile() {
    int status = 0;
    if (file_ != nullptr) fits_close_file(file_, &status);
    fits_clear_errmsg();
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  fitsfile* get() const { return file_; }

  static void require(int status) {
    if (status == 0) return;
    char words[FLEN_STATUS] = "";
    fits_get_errstatus(status, words);
    refuse(ErrorCode::bad_data, fmt::format("is damaged: {}", words));
  }

 private:
  std::vector<std::byte> bytes_;
  void* data_ = nullptr;
  std::size_t size_ = 0;
  fitsfile* file_ = nullptr;
};

struct Shape {
  int type = 0;  // of the numbers, once BZERO and BSCALE are applied
  int stored_type = 0;
  int axes = 0;
  LONGLONG sides[3] = {1, 1, 1};
};

Shape shape_of(fitsfile* file) {
  Shape shape;
  int status = 0;
  fits_get_img_paramll(file, 3, &shape.stored_type, &shape.axes, shape.sides, &status);
  fits_get_img_equivtype(file, &shape.type, &status);
  MemoryFile::require(status);
  return shape;
}

void require_grey(const Shape& shape) {
  if (shape.axes == 0) {
    refuse(ErrorCode::unsupported, "is compressed or empty; switch the driver's compression off");
  }
  if (shape.axes > 3 || (shape.axes == 3 && shape.sides[2] != 1)) {
    refuse(ErrorCode::unsupported,
           "has planes of colour; choose a grey or raw format (CCD_CAPTURE_FORMAT)");
  }
  if (shape.axes < 2) refuse(ErrorCode::bad_data, "has only one side");
  const bool is_integer =
      shape.type == BYTE_IMG || shape.type == SHORT_IMG || shape.type == USHORT_IMG;
  if (!is_integer) {
    refuse(ErrorCode::unsupported,
           fmt::format("has numbers of FITS type {} (BITPIX {}); choose a format of 8 or 16 bit "
                       "integers",
                       shape.type, shape.stored_type));
  }
}

void require_expected(const Shape& shape, const ExpectedPicture& expected) {
  if (shape.sides[0] != expected.width_px || shape.sides[1] != expected.height_px) {
    refuse(ErrorCode::bad_data,
           fmt::format("has {} x {} px, where CCD_FRAME and CCD_BINNING make {} x {}",
                       shape.sides[0], shape.sides[1], expected.width_px, expected.height_px));
  }
  if (expected.depth == Depth::bits8 && shape.type != BYTE_IMG) {
    refuse(ErrorCode::unsupported, "has 16 bits, where CCD_INFO says 8; choose one of both");
  }
}

/// bytes: how many came.
void require_all_there(fitsfile* file, const Shape& shape, std::size_t bytes) {
  LONGLONG header = 0, data = 0, end = 0;
  int status = 0;
  fits_get_hduaddrll(file, &header, &data, &end, &status);
  MemoryFile::require(status);
  const LONGLONG wanted =
      data + shape.sides[0] * shape.sides[1] * (shape.stored_type == BYTE_IMG ? 1 : 2);
  if (wanted > static_cast<LONGLONG>(bytes)) {
    refuse(ErrorCode::bad_data, fmt::format("is truncated: {} of {} bytes", bytes, wanted));
  }
}

template <class Pixel>
std::vector<Pixel> read_pixels(fitsfile* file, int type, const ExpectedPicture& expected) {
  std::vector<Pixel> pixels(static_cast<std::size_t>(expected.width_px) *
                            static_cast<std::size_t>(expected.height_px));
  int status = 0;
  fits_read_img(file, type, 1, static_cast<LONGLONG>(pixels.size()), nullptr, pixels.data(),
                nullptr, &status);
  if (status == NUM_OVERFLOW) {
    refuse(ErrorCode::unsupported, "has negative numbers; choose an unsigned format");
  }
  MemoryFile::require(status);
  return pixels;
}

}  // namespace

Frame decode_fits(std::vector<std::byte> bytes, const ExpectedPicture& expected) {
  const std::size_t came = bytes.size();
  if (came < kBlock) refuse(ErrorCode::bad_data, "is too short for FITS");
  const std::lock_guard<std::mutex> guard(cfitsio_lock());
  const MemoryFile file(std::move(bytes));
  const Shape shape = shape_of(file.get());
  require_grey(shape);
  require_expected(shape, expected);
  require_all_there(file.get(), shape, came);
  if (expected.depth == Depth::bits8) {
    return Frame(expected.width_px, expected.height_px,
                 read_pixels<std::uint8_t>(file.get(), TBYTE, expected));
  }
  return Frame(expected.width_px, expected.height_px,
               read_pixels<std::uint16_t>(file.get(), TUSHORT, expected));
}

}  // namespace fathom::indi
