// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/fits.hpp"

#include <fitsio.h>
#include <fmt/format.h>

#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "engine/error.hpp"
#include "hal/drivers/indi/fits_header.hpp"

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

/// What cfitsio reads: a header of ours, and the numbers that came, in whole blocks. cfitsio 4.2
/// reads beyond the end of memory that holds less (a fuzzer found that).
std::vector<std::byte> plain_file(const FitsHeader& header, std::span<const std::byte> numbers) {
  const std::string text = header.text();
  const auto* const first = reinterpret_cast<const std::byte*>(text.data());
  std::vector<std::byte> file;
  const std::size_t blocks = (numbers.size() + kFitsBlock - 1) / kFitsBlock;
  file.reserve(text.size() + blocks * kFitsBlock);
  file.assign(first, first + text.size());
  file.insert(file.end(), numbers.begin(), numbers.end());
  file.resize(text.size() + blocks * kFitsBlock);
  return file;
}

/// An open FITS file in memory.
class MemoryFile {
 public:
  explicit MemoryFile(std::vector<std::byte> bytes)
      : bytes_(std::move(bytes)), data_(bytes_.data()), size_(bytes_.size()) {
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

void require_grey(const FitsHeader& header) {
  const std::vector<std::int64_t>& sides = header.sides;
  if (sides.empty()) {
    refuse(ErrorCode::unsupported, "is compressed or empty; switch the driver's compression off");
  }
  if (sides.size() == 3 && sides[2] != 1) {
    refuse(ErrorCode::unsupported,
           "has planes of colour; choose a grey or raw format (CCD_CAPTURE_FORMAT)");
  }
  if (sides.size() < 2) refuse(ErrorCode::bad_data, "has only one side");
  const bool is_plain = header.scale == 1 && header.zero == 0;
  const bool is_unsigned = header.bits == 16 && header.scale == 1 && header.zero == 32768;
  if ((header.bits == 8 && is_plain) || (header.bits == 16 && is_plain) || is_unsigned) return;
  refuse(ErrorCode::unsupported,
         fmt::format("has numbers of BITPIX {}, BZERO {} and BSCALE {}; choose a format of 8 or 16 "
                     "bit integers",
                     header.bits, header.zero, header.scale));
}

void require_expected(const FitsHeader& header, const ExpectedPicture& expected) {
  if (header.sides[0] != expected.width_px || header.sides[1] != expected.height_px) {
    refuse(ErrorCode::bad_data,
           fmt::format("has {} x {} px, where CCD_FRAME and CCD_BINNING make {} x {}",
                       header.sides[0], header.sides[1], expected.width_px, expected.height_px));
  }
  if (expected.depth == Depth::bits8 && header.bits != 8) {
    refuse(ErrorCode::unsupported, "has 16 bits, where CCD_INFO says 8; choose one of both");
  }
}

/// The numbers of the picture; what follows them, another picture or a table, is left alone.
std::span<const std::byte> numbers_of(const FitsHeader& header, std::span<const std::byte> file) {
  const auto pixels = static_cast<std::size_t>(header.sides[0] * header.sides[1]);
  const std::size_t wanted = pixels * (header.bits == 8 ? 1 : 2);
  if (header.bytes <= file.size() && wanted <= file.size() - header.bytes) {
    return file.subspan(header.bytes, wanted);
  }
  refuse(ErrorCode::bad_data,
         fmt::format("is truncated: {} of {} bytes", file.size(), header.bytes + wanted));
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

Frame decode_fits(std::span<const std::byte> bytes, const ExpectedPicture& expected) {
  if (bytes.size() < kFitsBlock) refuse(ErrorCode::bad_data, "is too short for FITS");
  const FitsHeader header = read_fits_header(bytes);
  require_grey(header);
  require_expected(header, expected);
  const std::span<const std::byte> numbers = numbers_of(header, bytes);
  const std::lock_guard<std::mutex> guard(cfitsio_lock());
  const MemoryFile file(plain_file(header, numbers));
  if (expected.depth == Depth::bits8) {
    return Frame(expected.width_px, expected.height_px,
                 read_pixels<std::uint8_t>(file.get(), TBYTE, expected));
  }
  return Frame(expected.width_px, expected.height_px,
               read_pixels<std::uint16_t>(file.get(), TUSHORT, expected));
}

}  // namespace fathom::indi
