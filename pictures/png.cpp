// SPDX-License-Identifier: Apache-2.0
// PNG reading by libpng.
#include <bit>
#include <vector>

#include "engine/error.hpp"
#include "pictures/decoder.hpp"
#include "pictures/grey.hpp"
#include "pictures/png_calls.hpp"

namespace fathom::pictures {
namespace {

/// Deflate shrinks at most 1032 times (a run of 258 bytes in two bits).
constexpr std::uint64_t kMostShrinkage = 1032;

class PngReader {
 public:
  PngReader(const Source& source, Colour colour) : source_(source), colour_(colour) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &trouble_, on_png_error, on_png_warning);
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
  Frame read_pixels(const PictureShape& shape, std::uint64_t packed_bits_per_pixel,
                    Colours* colours) {
    const auto width = static_cast<std::size_t>(shape.width_px);
    require_bytes_for(source_, width * shape.height_px * packed_bits_per_pixel / 8, kMostShrinkage);
    const int channels = this->channels();
    const std::size_t row_samples = width * static_cast<std::size_t>(channels);
    // An interlaced picture comes in passes, each of which fills in more of every row.
    const std::size_t kept_rows = passes_ > 1 ? static_cast<std::size_t>(shape.height_px) : 1;
    std::vector<Sample> samples(row_samples * kept_rows);
    PixelSink<Sample> sink(shape, channels, colour_, colours);
    run([&] {
      for (int pass = 0; pass < passes_; ++pass) {
        for (int y = 0; y < shape.height_px; ++y) {
          Sample* row = samples.data() + (kept_rows > 1 ? y * row_samples : 0);
          png_read_row(png_, reinterpret_cast<png_bytep>(row), nullptr);
          if (pass == passes_ - 1) sink.put(static_cast<std::size_t>(y), row);
        }
      }
      png_read_end(png_, nullptr);
    });
    return sink.take();
  }

  /// Of the output: 1 for grey, 3 for colours.
  int channels() const { return png_get_channels(png_, info_); }

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
  Colour colour_;
  std::uint64_t offset_ = 0;
  PngTrouble trouble_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  int passes_ = 1;
};

class PngDecoder final : public Decoder {
 public:
  PngDecoder(const Source& source, Colour colour) : source_(source), colour_(colour) { shape(0); }

  PictureShape shape(std::size_t) override { return PngReader(source_, colour_).read_header(); }

  bool is_colour(std::size_t) override {
    PngReader reader(source_, colour_);
    reader.read_header();
    return reader.channels() > 1;
  }

  Frame read(std::size_t, Colours* colours) override {
    PngReader reader(source_, colour_);
    const PictureShape shape = reader.read_header();
    const std::uint64_t bits = reader.packed_bits_per_pixel();
    return shape.depth == Depth::bits16 ? reader.read_pixels<std::uint16_t>(shape, bits, colours)
                                        : reader.read_pixels<std::uint8_t>(shape, bits, colours);
  }

 private:
  const Source& source_;
  Colour colour_;
};

}  // namespace

std::unique_ptr<Decoder> open_png(const Source& source, const PictureOptions& options) {
  return std::make_unique<PngDecoder>(source, options.colour);
}

}  // namespace fathom::pictures
