// SPDX-License-Identifier: Apache-2.0
// TIFF by libtiff: any page of a stack, in strips or tiles.
#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/error.hpp"
#include "pictures/decoder.hpp"
#include "pictures/grey.hpp"

namespace fathom::pictures {
namespace {

/// What libtiff's callbacks are given: the file, where it reads, and the first error it met.
struct TiffClient {
  const Source* source = nullptr;
  std::uint64_t offset = 0;
  char message[300] = "";
};

TiffClient& client_of(thandle_t handle) { return *static_cast<TiffClient*>(handle); }

tmsize_t on_read(thandle_t handle, void* to, tmsize_t count) {
  TiffClient& client = client_of(handle);
  const std::size_t got = client.source->read(client.offset, to, static_cast<std::size_t>(count));
  client.offset += got;
  return static_cast<tmsize_t>(got);
}

tmsize_t on_write(thandle_t, void*, tmsize_t) { return 0; }

toff_t on_seek(thandle_t handle, toff_t offset, int whence) {
  TiffClient& client = client_of(handle);
  if (whence == SEEK_CUR) offset += client.offset;
  if (whence == SEEK_END) offset += client.source->size();
  return client.offset = offset;
}

toff_t on_size(thandle_t handle) { return client_of(handle).source->size(); }
int on_close(thandle_t) { return 0; }
int on_map(thandle_t, void**, toff_t*) { return 0; }
void on_unmap(thandle_t, void*, toff_t) {}

/// Returning 1 keeps libtiff from printing.
int on_error(TIFF*, void* handle, const char*, const char* format, va_list values) {
  TiffClient& client = client_of(handle);
  if (client.message[0] == '\0') {
    std::vsnprintf(client.message, sizeof client.message, format, values);
  }
  return 1;
}

/// The JPEG codec warns where pixels are lost, and libtiff where it drops a damaged palette and
/// would take its indices for grey levels; its other warnings are about odd tags.
int on_warning(TIFF* tiff, void* handle, const char* module, const char* format, va_list values) {
  char text[256];
  va_list again;
  va_copy(again, values);
  std::vsnprintf(text, sizeof text, format, again);
  va_end(again);
  const bool pixels_are_lost = module != nullptr && std::string_view(module) == "JPEGLib";
  const bool palette_is_lost = std::string_view(text).find("ColorMap") != std::string_view::npos;
  if (pixels_are_lost || palette_is_lost) on_error(tiff, handle, module, format, values);
  return 1;
}

struct Compression {
  std::uint16_t tag;
  std::uint64_t most_shrinkage;  // how many bytes one byte can unpack to, at most
};

constexpr Compression kCompressions[] = {
    {COMPRESSION_NONE, 1},       {COMPRESSION_PACKBITS, 128},
    {COMPRESSION_LZW, 4096},     {COMPRESSION_ADOBE_DEFLATE, 1032},
    {COMPRESSION_DEFLATE, 1032}, {COMPRESSION_ZSTD, 1 << 16},
    {COMPRESSION_LZMA, 1 << 16}, {COMPRESSION_JPEG, 1 << 14},
};

enum class Colour { grey, inverted, rgb, palette };

/// How one page lies in the file.
struct Layout {
  PictureShape shape;
  Colour colour = Colour::grey;
  std::uint16_t samples = 1;     // per pixel
  bool separate_planes = false;  // each sample of a pixel in a plane of its own
  bool tiled = false;
  std::uint32_t chunk_width = 0;   // of a tile, or of a strip: the whole width
  std::uint32_t chunk_height = 0;  // of a tile, or of a strip
  std::uint64_t most_shrinkage = 1;

  std::size_t planes_to_read() const { return separate_planes && colour == Colour::rgb ? 3 : 1; }
  std::size_t samples_per_chunk_pixel() const { return separate_planes ? 1 : samples; }
};

class TiffDecoder final : public Decoder {
 public:
  explicit TiffDecoder(const Source& source) {
    client_.source = &source;
    struct Options {
      TIFFOpenOptions* raw = TIFFOpenOptionsAlloc();
      ~Options() { TIFFOpenOptionsFree(raw); }
    } options;
    if (options.raw == nullptr) throw std::bad_alloc();
    TIFFOpenOptionsSetErrorHandlerExtR(options.raw, on_error, &client_);
    TIFFOpenOptionsSetWarningHandlerExtR(options.raw, on_warning, &client_);
    // libtiff's own buffers hold packed data and tables, never more than the file does.
    const std::uint64_t most = std::min<std::uint64_t>(source.size(), std::uint64_t{1} << 40);
    TIFFOpenOptionsSetMaxSingleMemAlloc(options.raw, static_cast<tmsize_t>(4 * most + (1 << 24)));
    tiff_.reset(TIFFClientOpenExt(source.name().c_str(), "rm", &client_, on_read, on_write, on_seek,
                                  on_close, on_size, on_map, on_unmap, options.raw));
    if (tiff_ == nullptr) fail();
    find_pages();
  }

  std::size_t page_count() const override { return offsets_.size(); }

  PictureShape shape(std::size_t page) override { return layout(page).shape; }

  Frame read(std::size_t page) override {
    const Layout page_layout = layout(page);
    return page_layout.shape.depth == Depth::bits16 ? read_pixels<std::uint16_t>(page_layout)
                                                    : read_pixels<std::uint8_t>(page_layout);
  }

 private:
  struct Close {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
  };

  const std::string& name() const { return client_.source->name(); }

  /// libtiff's word on what went wrong, without the file's name, which our own messages start with.
  std::string_view reason() const {
    std::string_view text = client_.message;
    if (text.starts_with(name() + ": ")) text.remove_prefix(name().size() + 2);
    return text.empty() ? "libtiff gives no reason" : text;
  }

  [[noreturn]] void fail() const { throw_damaged(name(), reason()); }

  /// Walks the chain of directories once, so that every page is one jump away afterwards.
  void find_pages() {
    do {
      offsets_.push_back(TIFFCurrentDirOffset(tiff_.get()));
      if (TIFFLastDirectory(tiff_.get())) return;
    } while (TIFFReadDirectory(tiff_.get()));
    throw_damaged(name(), fmt::format("its page {} cannot be read: {}", offsets_.size(), reason()));
  }

  std::uint32_t field(std::uint32_t tag) const {
    std::uint16_t value = 0;
    TIFFGetFieldDefaulted(tiff_.get(), tag, &value);
    return value;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} holds {}; save it as 8- or 16-bit grey or RGB", name(), what));
  }

  Layout layout(std::size_t page) {
    client_.message[0] = '\0';
    // Read again even where it is the current one: what libtiff says of it counts.
    if (TIFFSetSubDirectory(tiff_.get(), offsets_[page]) == 0 || client_.message[0] != '\0') fail();
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    TIFFGetField(tiff_.get(), TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff_.get(), TIFFTAG_IMAGELENGTH, &height);
    const std::uint32_t bits = field(TIFFTAG_BITSPERSAMPLE);
    const std::uint32_t sample_format = field(TIFFTAG_SAMPLEFORMAT);
    if (sample_format == SAMPLEFORMAT_IEEEFP) refuse(fmt::format("{}-bit floating point", bits));
    if (sample_format == SAMPLEFORMAT_INT) refuse("signed numbers");
    if (bits != 8 && bits != 16) refuse(fmt::format("{}-bit samples", bits));
    Layout result;
    result.shape = checked_shape(name(), width, height, bits == 16 ? Depth::bits16 : Depth::bits8);
    result.samples = static_cast<std::uint16_t>(field(TIFFTAG_SAMPLESPERPIXEL));
    result.most_shrinkage = shrinkage();
    result.colour = colour(result, bits);
    set_chunks(result);
    return result;
  }

  std::uint64_t shrinkage() const {
    const std::uint32_t tag = field(TIFFTAG_COMPRESSION);
    for (const Compression& known : kCompressions) {
      if (known.tag == tag && TIFFIsCODECConfigured(known.tag)) return known.most_shrinkage;
    }
    refuse(fmt::format("pixels packed by method {}", tag));
  }

  Colour colour(const Layout& layout, std::uint32_t bits) {
    const std::uint32_t photometric = field(TIFFTAG_PHOTOMETRIC);
    if (layout.samples < 1) refuse("pixels without samples");
    if (photometric == PHOTOMETRIC_MINISBLACK) return Colour::grey;
    if (photometric == PHOTOMETRIC_MINISWHITE) return Colour::inverted;
    if (photometric == PHOTOMETRIC_RGB && layout.samples >= 3) return Colour::rgb;
    if (photometric == PHOTOMETRIC_PALETTE && bits == 8 && layout.samples == 1) {
      return Colour::palette;
    }
    if (photometric == PHOTOMETRIC_YCBCR && field(TIFFTAG_COMPRESSION) == COMPRESSION_JPEG &&
        layout.samples == 3 && field(TIFFTAG_PLANARCONFIG) == PLANARCONFIG_CONTIG) {
      TIFFSetField(tiff_.get(), TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
      return Colour::rgb;
    }
    refuse(fmt::format("colours of kind {} with {} samples", photometric, layout.samples));
  }

  void set_chunks(Layout& layout) {
    layout.separate_planes = field(TIFFTAG_PLANARCONFIG) == PLANARCONFIG_SEPARATE;
    layout.tiled = TIFFIsTiled(tiff_.get()) != 0;
    if (layout.tiled) {
      TIFFGetField(tiff_.get(), TIFFTAG_TILEWIDTH, &layout.chunk_width);
      TIFFGetField(tiff_.get(), TIFFTAG_TILELENGTH, &layout.chunk_height);
    } else {
      layout.chunk_width = static_cast<std::uint32_t>(layout.shape.width_px);
      TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_ROWSPERSTRIP, &layout.chunk_height);
      layout.chunk_height =
          std::min(layout.chunk_height, static_cast<std::uint32_t>(layout.shape.height_px));
    }
    checked_shape(name(), layout.chunk_width, layout.chunk_height, layout.shape.depth);
  }

  template <class Sample>
  Frame read_pixels(const Layout& layout) {
    const auto width = static_cast<std::uint32_t>(layout.shape.width_px);
    const auto height = static_cast<std::uint32_t>(layout.shape.height_px);
    const std::uint64_t chunk_samples =
        std::uint64_t{layout.chunk_width} * layout.chunk_height * layout.samples_per_chunk_pixel();
    const std::uint64_t page_samples = std::uint64_t{width} * height * layout.samples;
    require_bytes_for(*client_.source, std::max(chunk_samples, page_samples) * sizeof(Sample),
                      layout.most_shrinkage);
    std::array<std::vector<Sample>, 3> planes;
    for (std::size_t p = 0; p < layout.planes_to_read(); ++p) planes[p].resize(chunk_samples);
    std::vector<Sample> grey(std::size_t{width} * height);
    const auto palette = read_palette(layout);
    for (std::uint32_t top = 0; top < height; top += layout.chunk_height) {
      for (std::uint32_t left = 0; left < width; left += layout.chunk_width) {
        for (std::size_t p = 0; p < layout.planes_to_read(); ++p) {
          read_chunk(layout, left, top, static_cast<std::uint16_t>(p), planes[p]);
        }
        put_chunk(layout, left, top, planes, palette, grey);
      }
    }
    return Frame(layout.shape.width_px, layout.shape.height_px, std::move(grey));
  }

  template <class Sample>
  void read_chunk(const Layout& layout, std::uint32_t left, std::uint32_t top, std::uint16_t plane,
                  std::vector<Sample>& samples) {
    const std::uint32_t rows =
        layout.tiled ? layout.chunk_height
                     : std::min(layout.chunk_height,
                                static_cast<std::uint32_t>(layout.shape.height_px) - top);
    const auto bytes = static_cast<tmsize_t>(std::uint64_t{layout.chunk_width} * rows *
                                             layout.samples_per_chunk_pixel() * sizeof(Sample));
    TIFF* tiff = tiff_.get();
    const tmsize_t whole = layout.tiled ? TIFFTileSize(tiff) : TIFFVStripSize(tiff, rows);
    if (whole != bytes) refuse("pixels in an unusual layout");
    const tmsize_t got =
        layout.tiled
            ? TIFFReadEncodedTile(tiff, TIFFComputeTile(tiff, left, top, 0, plane), samples.data(),
                                  bytes)
            : TIFFReadEncodedStrip(tiff, TIFFComputeStrip(tiff, top, plane), samples.data(), bytes);
    if (got != bytes || client_.message[0] != '\0') fail();
  }

  template <class Sample>
  static void put_chunk(const Layout& layout, std::uint32_t left, std::uint32_t top,
                        const std::array<std::vector<Sample>, 3>& planes,
                        const std::vector<std::uint8_t>& palette, std::vector<Sample>& grey) {
    const auto width = static_cast<std::uint32_t>(layout.shape.width_px);
    const auto height = static_cast<std::uint32_t>(layout.shape.height_px);
    const std::uint32_t rows = std::min(layout.chunk_height, height - top);
    const std::uint32_t columns = std::min(layout.chunk_width, width - left);
    const std::size_t step = layout.samples_per_chunk_pixel();
    const bool apart = layout.separate_planes;
    for (std::uint32_t y = 0; y < rows; ++y) {
      for (std::uint32_t x = 0; x < columns; ++x) {
        const std::size_t at = (std::size_t{y} * layout.chunk_width + x) * step;
        const Sample first = planes[0][at];
        Sample value = first;
        switch (layout.colour) {
          case Colour::grey:
            break;
          case Colour::inverted:
            value = static_cast<Sample>(~first);
            break;
          case Colour::palette:
            value = palette[first & 0xff];
            break;
          case Colour::rgb:
            value = apart ? luma(first, planes[1][at], planes[2][at])
                          : luma(first, planes[0][at + 1], planes[0][at + 2]);
            break;
        }
        grey[std::size_t{top + y} * width + left + x] = value;
      }
    }
  }

  /// The grey value of each of the 256 colours. The map's values are 16 bit, but old writers filled
  /// in 8.
  std::vector<std::uint8_t> read_palette(const Layout& layout) const {
    if (layout.colour != Colour::palette) return {};
    std::uint16_t* red = nullptr;
    std::uint16_t* green = nullptr;
    std::uint16_t* blue = nullptr;
    if (TIFFGetField(tiff_.get(), TIFFTAG_COLORMAP, &red, &green, &blue) == 0) {
      throw_damaged(name(), "its colour map is missing");
    }
    const auto is_wide = [](std::uint16_t value) { return value > 255; };
    const bool wide = std::any_of(red, red + 256, is_wide) ||
                      std::any_of(green, green + 256, is_wide) ||
                      std::any_of(blue, blue + 256, is_wide);
    const int shift = wide ? 8 : 0;
    std::vector<std::uint8_t> grey(256);
    for (std::size_t i = 0; i < grey.size(); ++i) {
      grey[i] = luma(static_cast<std::uint8_t>(red[i] >> shift),
                     static_cast<std::uint8_t>(green[i] >> shift),
                     static_cast<std::uint8_t>(blue[i] >> shift));
    }
    return grey;
  }

  TiffClient client_;
  std::unique_ptr<TIFF, Close> tiff_;
  std::vector<std::uint64_t> offsets_;  // of each page's directory
};

}  // namespace

std::unique_ptr<Decoder> open_tiff(const Source& source) {
  return std::make_unique<TiffDecoder>(source);
}

}  // namespace fathom::pictures
