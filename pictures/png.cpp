// SPDX-License-Identifier: Apache-2.0
// PNG by libpng.
//
// libpng reports errors by longjmp, which skips destructors. So every call of it stands in the body
// of guarded(), and no such body holds an object that needs one.
#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <vector>

#include "engine/error.hpp"
#include "pictures/decoder.hpp"
#include "pictures/grey.hpp"

namespace fathom::pictures {
namespace {

/// Deflate shrinks at most 1032 times (a run of 258 bytes in two bits).
constexpr std::uint64_t kMostShrinkage = 1032;

/// Where libpng's error function leaves its message before it jumps back.
struct PngTrouble {
  char message[200] = "";
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto* trouble = static_cast<PngTrouble*>(png_get_error_ptr(png));
  std::snprintf(trouble->message, sizeof trouble->message, "%s", message);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}  // damage that matters is an error

/// Runs libpng calls; false if one of them failed.
template <class Body>
bool guarded(png_structp png, Body body) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  body();
  return true;
}

class PngReader {
 public:
  explicit PngReader(const Source& source) : source_(source) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &trouble_, on_error, on_warning);
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
  }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }

  /// Reads up to the pixels and asks for grey or RGB without alpha, 8 bit or 16 bit in native
  /// order.
  PictureShape read_header() {
    run([this] {
      png_set_read_fn(png_, this, on_read);
      png_set_user_limits(png_, kLargestPictureSide, kLargestPictureSide);
      png_read_info(png_, info_);
      png_set_expand(png_);
      png_set_strip_alpha(png_);
      if constexpr (std::endian::native == std::endian::little) png_set_swap(png_);
      passes_ = png_set_interlace_handling(png_);
      png_read_update_info(png_, info_);
    });
    const Depth depth = png_get_bit_depth(png_, info_) == 16 ? Depth::bits16 : Depth::bits8;
    return checked_shape(source_.name(), png_get_image_width(png_, info_),
                         png_get_image_height(png_, info_), depth);
  }

  template <class Sample>
  Frame read_pixels(const PictureShape& shape, std::uint64_t packed_bits_per_pixel) {
    const auto width = static_cast<std::size_t>(shape.width_px);
    require_bytes_for(source_, width * shape.height_px * packed_bits_per_pixel / 8, kMostShrinkage);
    const int channels = png_get_channels(png_, info_);
    const std::size_t row_samples = width * static_cast<std::size_t>(channels);
    // An interlaced picture comes in passes, each of which fills in more of every row.
    const std::size_t kept_rows = passes_ > 1 ? static_cast<std::size_t>(shape.height_px) : 1;
    std::vector<Sample> samples(row_samples * kept_rows);
    std::vector<Sample> grey(width * shape.height_px);
    run([&] {
      for (int pass = 0; pass < passes_; ++pass) {
        for (int y = 0; y < shape.height_px; ++y) {
          Sample* row = samples.data() + (kept_rows > 1 ? y * row_samples : 0);
          png_read_row(png_, reinterpret_cast<png_bytep>(row), nullptr);
          if (pass == passes_ - 1) grey_row(row, width, channels, grey.data() + y * width);
        }
      }
      png_read_end(png_, nullptr);
    });
    return Frame(shape.width_px, shape.height_px, std::move(grey));
  }

  /// Bits of one pixel in the file, before it is spread to whole bytes.
  std::uint64_t packed_bits_per_pixel() const {
    // After png_read_update_info the info structure tells the output; the file's own header is 8
    // bytes of signature, 8 of chunk head, 8 of size, then bit depth and colour type.
    unsigned char header[2] = {8, 0};
    source_.read(24, header, sizeof header);
    const std::uint64_t channels = header[1] == PNG_COLOR_TYPE_RGB          ? 3
                                   : header[1] == PNG_COLOR_TYPE_RGB_ALPHA  ? 4
                                   : header[1] == PNG_COLOR_TYPE_GRAY_ALPHA ? 2
                                                                            : 1;
    return channels * header[0];
  }

 private:
  static void on_read(png_structp png, png_bytep to, std::size_t count) {
    auto* self = static_cast<PngReader*>(png_get_io_ptr(png));
    const std::size_t got = self->source_.read(self->offset_, to, count);
    if (got < count) png_error(png, "the file ends too early");
    self->offset_ += count;
  }

  template <class Body>
  void run(Body body) {
    if (!guarded(png_, body)) throw_damaged(source_.name(), trouble_.message);
  }

  const Source& source_;
  std::uint64_t offset_ = 0;
  PngTrouble trouble_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  int passes_ = 1;
};

class PngDecoder final : public Decoder {
 public:
  explicit PngDecoder(const Source& source) : source_(source) { PngReader(source_).read_header(); }

  PictureShape shape(std::size_t) override { return PngReader(source_).read_header(); }

  Frame read(std::size_t) override {
    PngReader reader(source_);
    const PictureShape shape = reader.read_header();
    const std::uint64_t bits = reader.packed_bits_per_pixel();
    return shape.depth == Depth::bits16 ? reader.read_pixels<std::uint16_t>(shape, bits)
                                        : reader.read_pixels<std::uint8_t>(shape, bits);
  }

 private:
  const Source& source_;
};

/// What the writing callbacks share: the file so far, and whether memory ran out.
void on_write(png_structp png, png_bytep bytes, std::size_t count) {
  bool out_of_memory = false;
  try {
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<char*>(bytes), count);
  } catch (const std::bad_alloc&) {
    out_of_memory = true;  // png_error must not jump out of a catch block
  }
  if (out_of_memory) png_error(png, "not enough memory");
}

void write_rows(png_structp png, png_infop info, const Frame& frame, std::vector<png_byte>& row,
                std::string& file) {
  png_set_write_fn(png, &file, on_write, nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(frame.width_px()),
               static_cast<png_uint_32>(frame.height_px()), static_cast<int>(frame.depth()),
               PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  if constexpr (std::endian::native == std::endian::little) png_set_swap(png);
  for (int y = 0; y < frame.height_px(); ++y) {
    std::memcpy(row.data(), frame.row(y), row.size());  // libpng swaps 16-bit rows in its own copy
    png_write_row(png, row.data());
  }
  png_write_end(png, nullptr);
}

}  // namespace

std::unique_ptr<Decoder> open_png(const Source& source) {
  return std::make_unique<PngDecoder>(source);
}

std::string encode_png(const Frame& frame) {
  PngTrouble trouble;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &trouble, on_error, on_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  std::string file;
  std::vector<png_byte> row(static_cast<std::size_t>(frame.width_px()) *
                            bytes_per_pixel(frame.depth()));
  const bool written =
      info != nullptr && guarded(png, [&] { write_rows(png, info, frame, row, file); });
  png_destroy_write_struct(&png, &info);
  if (!written) {
    throw Error(ErrorCode::out_of_memory, std::string("cannot make a PNG: ") + trouble.message);
  }
  return file;
}

}  // namespace fathom::pictures
