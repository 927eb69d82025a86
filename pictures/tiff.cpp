// SPDX-License-Identifier: Apache-2.0
// TIFF by libtiff: the pixels of any page, in strips or tiles.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "engine/error.hpp"
#include "pictures/decoder.hpp"
#include "pictures/grey.hpp"
#include "pictures/tiff_pages.hpp"
#include "pictures/wide_samples.hpp"

namespace fathom::pictures {
namespace {

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

enum class Photometry { grey, inverted, rgb, palette };

/// What one sample is in the file.
enum class SampleKind { uint8, uint16, int16, uint32, int32, float32, float64 };

/// How one page lies in the file.
struct Layout {
  PictureShape shape;
  SampleKind kind = SampleKind::uint8;
  Photometry photometry = Photometry::grey;
  std::uint16_t samples = 1;     // per pixel
  bool separate_planes = false;  // each sample of a pixel in a plane of its own
  bool tiled = false;
  std::uint32_t chunk_width = 0;   // of a tile, or of a strip: the whole width
  std::uint32_t chunk_height = 0;  // of a tile, or of a strip
  std::uint64_t most_shrinkage = 1;
  TiffPage page;
  Colours* colours = nullptr;  // where they are kept, or null

  std::size_t planes_to_read() const {
    return separate_planes && photometry == Photometry::rgb ? 3 : 1;
  }
  std::size_t samples_per_chunk_pixel() const { return separate_planes ? 1 : samples; }
};

class TiffDecoder final : public Decoder {
 public:
  TiffDecoder(const Source& source, const PictureOptions& options)
      : options_(options), file_(source), pages_(list_pages(file_)) {}

  const PictureContents& contents() const override { return pages_.contents; }

  PictureShape shape(std::size_t page) override { return layout(page).shape; }

  bool is_colour(std::size_t page) override {
    const Photometry photometry = layout(page).photometry;
    return photometry == Photometry::rgb || photometry == Photometry::palette;
  }

  Frame read(std::size_t page, Colours* colours) override {
    Layout page_layout = layout(page);
    const bool is_colour =
        page_layout.photometry == Photometry::rgb || page_layout.photometry == Photometry::palette;
    if (is_colour) page_layout.colours = colours;
    switch (page_layout.kind) {
      case SampleKind::uint8:
        return frame_of<std::uint8_t>(page_layout);
      case SampleKind::uint16:
        return frame_of<std::uint16_t>(page_layout);
      case SampleKind::int16:
        return frame_of<std::int16_t>(page_layout);
      case SampleKind::uint32:
        return frame_of<std::uint32_t>(page_layout);
      case SampleKind::int32:
        return frame_of<std::int32_t>(page_layout);
      case SampleKind::float32:
        return frame_of<float>(page_layout);
      case SampleKind::float64:
        return frame_of<double>(page_layout);
    }
    refuse("samples of an unknown kind");
  }

 private:
  const std::string& name() const { return file_.name(); }
  TIFF* tiff() const { return file_.get(); }
  std::uint32_t field(std::uint32_t tag) const { return file_.field(tag); }
  [[noreturn]] void fail() const { throw_damaged(name(), file_.reason()); }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} holds {}; save it as 8- or 16-bit grey or RGB", name(), what));
  }

  Layout layout(std::size_t page) {
    const TiffPage& place = pages_.pages[page];
    if (!file_.select(place.directory)) fail();
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    TIFFGetField(tiff(), TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff(), TIFFTAG_IMAGELENGTH, &height);
    Layout result;
    result.page = place;
    result.kind = sample_kind();
    result.shape = checked_shape(name(), width, height,
                                 result.kind == SampleKind::uint8 ? Depth::bits8 : Depth::bits16);
    result.samples = static_cast<std::uint16_t>(field(TIFFTAG_SAMPLESPERPIXEL));
    result.most_shrinkage = shrinkage();
    result.photometry = photometry(result);
    set_chunks(result);
    return result;
  }

  SampleKind sample_kind() const {
    const std::uint32_t bits = field(TIFFTAG_BITSPERSAMPLE);
    switch (field(TIFFTAG_SAMPLEFORMAT)) {
      case SAMPLEFORMAT_IEEEFP:
        if (bits == 32) return SampleKind::float32;
        if (bits == 64) return SampleKind::float64;
        refuse(fmt::format("{}-bit floating point", bits));
      case SAMPLEFORMAT_INT:
        if (bits == 16) return SampleKind::int16;
        if (bits == 32) return SampleKind::int32;
        refuse(fmt::format("{}-bit signed samples", bits));
      case SAMPLEFORMAT_COMPLEXINT:
      case SAMPLEFORMAT_COMPLEXIEEEFP:
        refuse("complex numbers");
    }
    if (bits == 8) return SampleKind::uint8;
    if (bits == 16) return SampleKind::uint16;
    if (bits == 32) return SampleKind::uint32;
    refuse(fmt::format("{}-bit samples", bits));
  }

  std::uint64_t shrinkage() const {
    const std::uint32_t tag = field(TIFFTAG_COMPRESSION);
    for (const Compression& known : kCompressions) {
      if (known.tag == tag && TIFFIsCODECConfigured(known.tag)) return known.most_shrinkage;
    }
    refuse(fmt::format("pixels packed by method {}", tag));
  }

  Photometry photometry(const Layout& layout) {
    const std::uint32_t photometric = field(TIFFTAG_PHOTOMETRIC);
    const bool is_narrow = layout.kind == SampleKind::uint8 || layout.kind == SampleKind::uint16;
    if (layout.samples < 1) refuse("pixels without samples");
    if (photometric == PHOTOMETRIC_MINISBLACK) return Photometry::grey;
    if (!is_narrow) refuse("colours or inverted greys of more than 16 bits");
    if (photometric == PHOTOMETRIC_MINISWHITE) return Photometry::inverted;
    if (photometric == PHOTOMETRIC_RGB && layout.samples >= 3) return Photometry::rgb;
    if (photometric == PHOTOMETRIC_PALETTE && layout.kind == SampleKind::uint8 &&
        layout.samples == 1) {
      return Photometry::palette;
    }
    if (photometric == PHOTOMETRIC_YCBCR && field(TIFFTAG_COMPRESSION) == COMPRESSION_JPEG &&
        layout.samples == 3 && field(TIFFTAG_PLANARCONFIG) == PLANARCONFIG_CONTIG) {
      TIFFSetField(tiff(), TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
      return Photometry::rgb;
    }
    refuse(fmt::format("colours of kind {} with {} samples", photometric, layout.samples));
  }

  void set_chunks(Layout& layout) {
    layout.separate_planes = field(TIFFTAG_PLANARCONFIG) == PLANARCONFIG_SEPARATE;
    layout.tiled = TIFFIsTiled(tiff()) != 0;
    if (layout.tiled) {
      TIFFGetField(tiff(), TIFFTAG_TILEWIDTH, &layout.chunk_width);
      TIFFGetField(tiff(), TIFFTAG_TILELENGTH, &layout.chunk_height);
    } else {
      layout.chunk_width = static_cast<std::uint32_t>(layout.shape.width_px);
      TIFFGetFieldDefaulted(tiff(), TIFFTAG_ROWSPERSTRIP, &layout.chunk_height);
      layout.chunk_height =
          std::min(layout.chunk_height, static_cast<std::uint32_t>(layout.shape.height_px));
    }
    checked_shape(name(), layout.chunk_width, layout.chunk_height, layout.shape.depth);
  }

  template <class Sample>
  Frame frame_of(const Layout& layout) {
    std::vector<Sample> samples = read_pixels<Sample>(layout);
    const PictureShape& shape = layout.shape;
    if constexpr (std::is_same_v<Sample, std::uint8_t> || std::is_same_v<Sample, std::uint16_t>) {
      return Frame(shape.width_px, shape.height_px, std::move(samples));
    } else {
      return Frame(shape.width_px, shape.height_px,
                   grey_levels<Sample>(samples, options_.scale, name()));
    }
  }

  template <class Sample>
  std::vector<Sample> read_pixels(const Layout& layout) {
    const auto width = static_cast<std::uint32_t>(layout.shape.width_px);
    const auto height = static_cast<std::uint32_t>(layout.shape.height_px);
    const std::uint64_t chunk_samples =
        std::uint64_t{layout.chunk_width} * layout.chunk_height * layout.samples_per_chunk_pixel();
    const std::uint64_t page_samples = std::uint64_t{width} * height * layout.samples;
    require_bytes_for(file_.source(), std::max(chunk_samples, page_samples) * sizeof(Sample),
                      layout.most_shrinkage);
    std::array<std::vector<Sample>, 3> planes;
    for (std::size_t p = 0; p < layout.planes_to_read(); ++p) planes[p].resize(chunk_samples);
    std::vector<Sample> grey(std::size_t{width} * height);
    keep_room<Sample>(layout);
    const auto palette = read_palette(layout);
    for (std::uint32_t top = 0; top < height; top += layout.chunk_height) {
      for (std::uint32_t left = 0; left < width; left += layout.chunk_width) {
        for (std::size_t p = 0; p < layout.planes_to_read(); ++p) {
          const std::size_t plane = layout.separate_planes ? p + layout.page.sample : 0;
          read_chunk(layout, left, top, static_cast<std::uint16_t>(plane), planes[p]);
        }
        put_chunk(layout, left, top, planes, palette, grey);
      }
    }
    return grey;
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
    const tmsize_t whole = layout.tiled ? TIFFTileSize(tiff()) : TIFFVStripSize(tiff(), rows);
    if (whole != bytes) refuse("pixels in an unusual layout");
    if (layout.page.shift > 0) return read_hidden_strip(layout, top, plane, bytes, samples);
    const tmsize_t got =
        layout.tiled ? TIFFReadEncodedTile(tiff(), TIFFComputeTile(tiff(), left, top, 0, plane),
                                           samples.data(), bytes)
                     : TIFFReadEncodedStrip(tiff(), TIFFComputeStrip(tiff(), top, plane),
                                            samples.data(), bytes);
    if (got != bytes || file_.in_trouble()) fail();
  }

  /// A strip of a plane that has no directory of its own, which libtiff cannot reach.
  template <class Sample>
  void read_hidden_strip(const Layout& layout, std::uint32_t top, std::uint16_t plane,
                         tmsize_t bytes, std::vector<Sample>& samples) const {
    const std::uint64_t* offsets = nullptr;
    TIFFGetField(tiff(), TIFFTAG_STRIPOFFSETS, &offsets);
    const std::uint64_t offset = offsets[TIFFComputeStrip(tiff(), top, plane)] + layout.page.shift;
    const auto count = static_cast<std::size_t>(bytes);
    if (file_.source().read(offset, samples.data(), count) != count)
      throw_damaged(name(), "the file ends too early");
    if (!TIFFIsByteSwapped(tiff())) return;
    auto* const raw = reinterpret_cast<std::uint8_t*>(samples.data());
    for (std::size_t at = 0; at < count; at += sizeof(Sample))
      std::reverse(raw + at, raw + at + sizeof(Sample));
  }

  template <class Sample>
  void put_chunk(const Layout& layout, std::uint32_t left, std::uint32_t top,
                 const std::array<std::vector<Sample>, 3>& planes,
                 const std::vector<std::uint8_t>& palette, std::vector<Sample>& grey) const {
    const auto width = static_cast<std::uint32_t>(layout.shape.width_px);
    const auto height = static_cast<std::uint32_t>(layout.shape.height_px);
    const std::uint32_t rows = std::min(layout.chunk_height, height - top);
    const std::uint32_t columns = std::min(layout.chunk_width, width - left);
    const std::size_t step = layout.samples_per_chunk_pixel();
    const std::size_t sample = layout.separate_planes ? 0 : layout.page.sample;
    for (std::uint32_t y = 0; y < rows; ++y) {
      for (std::uint32_t x = 0; x < columns; ++x) {
        const std::size_t at = (std::size_t{y} * layout.chunk_width + x) * step + sample;
        const std::size_t pixel = std::size_t{top + y} * width + left + x;
        grey[pixel] = grey_at(layout, planes, palette, at);
        if (layout.colours != nullptr) keep_colour(layout, planes, palette, at, pixel);
      }
    }
  }

  template <class Sample>
  static void keep_room(const Layout& layout) {
    if constexpr (std::is_same_v<Sample, std::uint8_t> || std::is_same_v<Sample, std::uint16_t>) {
      if (layout.colours == nullptr) return;
      const std::size_t pixels = std::size_t{1} * layout.shape.width_px * layout.shape.height_px;
      layout.colours->of<Sample>().resize(3 * pixels);
    }
  }

  template <class Sample>
  static void keep_colour(const Layout& layout, const std::array<std::vector<Sample>, 3>& planes,
                          const std::vector<std::uint8_t>& palette, std::size_t at,
                          std::size_t pixel) {
    if constexpr (std::is_same_v<Sample, std::uint8_t> || std::is_same_v<Sample, std::uint16_t>) {
      Sample* const kept = layout.colours->of<Sample>().data() + 3 * pixel;
      for (std::size_t c = 0; c < 3; ++c) {
        kept[c] = layout.photometry == Photometry::palette
                      ? palette[3 * std::size_t{planes[0][at] & 0xffu} + c]
                  : layout.separate_planes ? planes[c][at]
                                           : planes[0][at + c];
      }
    }
  }

  template <class Sample>
  Sample grey_at(const Layout& layout, const std::array<std::vector<Sample>, 3>& planes,
                 const std::vector<std::uint8_t>& palette, std::size_t at) const {
    const Sample first = planes[0][at];
    if constexpr (std::is_same_v<Sample, std::uint8_t> || std::is_same_v<Sample, std::uint16_t>) {
      const bool apart = layout.separate_planes;
      switch (layout.photometry) {
        case Photometry::grey:
          return first;
        case Photometry::inverted:
          return static_cast<Sample>(~first);
        case Photometry::palette:
          return fathom::pictures::grey_of<Sample>(options_.colour, palette[3 * (first & 0xffu)],
                                                   palette[3 * (first & 0xffu) + 1],
                                                   palette[3 * (first & 0xffu) + 2]);
        case Photometry::rgb:
          return fathom::pictures::grey_of(options_.colour, first,
                                           apart ? planes[1][at] : planes[0][at + 1],
                                           apart ? planes[2][at] : planes[0][at + 2]);
      }
    }
    return first;
  }

  /// Red, green and blue of each of the 256 colours. The map's values are 16 bit, but old writers filled
  /// in 8.
  std::vector<std::uint8_t> read_palette(const Layout& layout) const {
    if (layout.photometry != Photometry::palette) return {};
    std::uint16_t* red = nullptr;
    std::uint16_t* green = nullptr;
    std::uint16_t* blue = nullptr;
    if (TIFFGetField(tiff(), TIFFTAG_COLORMAP, &red, &green, &blue) == 0) {
      throw_damaged(name(), "its colour map is missing");
    }
    const auto is_wide = [](std::uint16_t value) { return value > 255; };
    const bool wide = std::any_of(red, red + 256, is_wide) ||
                      std::any_of(green, green + 256, is_wide) ||
                      std::any_of(blue, blue + 256, is_wide);
    const int shift = wide ? 8 : 0;
    std::vector<std::uint8_t> palette;
    for (std::size_t i = 0; i < 256; ++i) {
      for (const std::uint16_t* const map : {red, green, blue})
        palette.push_back(static_cast<std::uint8_t>(map[i] >> shift));
    }
    return palette;
  }

  PictureOptions options_;
  TiffFile file_;
  TiffPages pages_;
};

}  // namespace

std::unique_ptr<Decoder> open_tiff(const Source& source, const PictureOptions& options) {
  return std::make_unique<TiffDecoder>(source, options);
}

}  // namespace fathom::pictures
