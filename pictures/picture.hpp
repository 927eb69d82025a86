// SPDX-License-Identifier: Apache-2.0
// Picture files to frames, and frames to picture files.
//
// Every picture becomes grey: 8-bit files give Depth::bits8, deeper ones Depth::bits16, with the
// file's own values, not rescaled (PNG of 1, 2 or 4 bits is the exception: it is spread over
// 0..255). Colour becomes grey by BT.601 luma, 0.299 R + 0.587 G + 0.114 B rounded to nearest, or
// one colour alone where that is asked for; alpha is ignored. A JPEG that its camera stored turned
// (EXIF) is turned upright.
//
// Read are PNG, JPEG (grey and colour, no CMYK), TIFF (grey of 8, 16 and 32 bit and floating point;
// RGB and palette of 8 and 16 bit; strips and tiles; uncompressed, LZW, Deflate, PackBits,
// Zstandard, LZMA and JPEG) and PGM/PPM (binary and ASCII, up to 65535).
//
// Numbers beyond 16 bits, signed ones and floating point become grey levels: times
// PictureOptions::scale, rounded. Without a scale they are taken as they are, if they lie in
// 0..65535 and rounding does not cost more than a part in 256; else the picture is refused, with
// its range.
//
// Pages. The pages of a TIFF are its pictures: those marked as previews or masks are left out. The
// planes that ImageJ and MetaMorph write behind one directory, and samples of a pixel that are no
// colours, are pages too.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "../engine/colours.hpp"
#include "../engine/frame.hpp"

namespace fathom {

/// Formats, told apart by the file's first bytes, never by its name.
enum class PictureFormat { png, jpeg, tiff, pnm };

/// Pictures wider or taller than this are refused: no focus camera makes them, but a damaged header
/// does.
inline constexpr int kLargestPictureSide = 65536;
/// And so are pictures of more pixels than most_picture_pixels(), before any memory is taken: small
/// files can claim very large pictures. FATHOM_MEGAPIXELS, a number from 1 to 4096, sets it.
inline constexpr std::size_t kDefaultMegapixels = 256;
std::size_t most_picture_pixels();

/// What a picture's header says.
struct PictureShape {
  int width_px = 0;
  int height_px = 0;
  Depth depth = Depth::bits8;

  bool operator==(const PictureShape&) const = default;
};

/// What becomes of colour pictures; grey ones are what they are.
enum class Colour { luma, red, green, blue };

/// How a picture is read.
struct PictureOptions {
  Colour colour = Colour::luma;
  /// What floating-point, signed and 32-bit samples are multiplied by; 0: see above.
  double scale = 0;
};

/// A stack with channels and times, as ImageJ and OME describe it in a TIFF.
struct PictureStack {
  static constexpr std::size_t kMissing = static_cast<std::size_t>(-1);

  std::size_t channels = 1, slices = 1, times = 1;
  std::vector<std::string> channel_names;  ///< Empty, or one a channel.
  std::optional<double> spacing_um;        ///< From one slice to the next.
  /// The page of each plane, or kMissing where this file has it not: channels * slices * times.
  std::vector<std::size_t> pages = {};

  std::size_t page_of(std::size_t channel, std::size_t slice, std::size_t time) const {
    return pages[(time * channels + channel) * slices + slice];
  }
};

/// What a file holds, as its headers tell.
struct PictureContents {
  std::size_t pages = 1;
  std::map<std::size_t, std::string> damaged;  ///< Pages that cannot be read, and why.
  std::size_t lost = 0;      ///< More pages that the file promises and that lie beyond its end.
  std::size_t previews = 0;  ///< Pages left out because they are marked as such.
  std::size_t samples_as_pages = 0;     ///< Samples of one pixel that became pages, or 0.
  std::vector<PictureStack> stacks;     ///< Empty where the file says nothing of its pages.
  bool is_description_damaged = false;  ///< Or where what it says cannot be read.
  std::vector<std::string> words;       ///< What the format's library warns of.
};

/// "2048 x 1536 px, 8 bit", for messages.
std::string to_string(const PictureShape& shape);

/// An open picture file. Pixels are read from the disk when they are asked for, and any page of a
/// TIFF at the same cost, so that a stack larger than the memory can be walked in any order.
class PictureFile {
 public:
  /// Opens a file and reads its first header (of a TIFF, all). Throws Error(io) with the system's
  /// reason, Error(bad_data) if the file is empty, no picture, a device or damaged.
  explicit PictureFile(const std::filesystem::path& path, const PictureOptions& options = {});
  /// The same for bytes in memory, which must outlive this; `name` stands in error messages.
  PictureFile(std::string_view bytes, std::string name, const PictureOptions& options = {});
  PictureFile(PictureFile&&) noexcept;
  PictureFile& operator=(PictureFile&&) noexcept;
  ~PictureFile();

  PictureFormat format() const { return format_; }

  /// How many pictures the file holds: the pages of a TIFF, 1 for everything else.
  std::size_t page_count() const { return contents().pages; }

  /// What is known of the pages without their pixels.
  const PictureContents& contents() const;

  /// Whether a page is of colours, so that PictureOptions::colour matters. Throws as shape() does.
  bool is_colour(std::size_t page = 0);

  /// Size and depth of one page, 0-based, from its header alone. Throws Error(out_of_bounds) for a
  /// page that is not there, Error(bad_data) for a damaged page, a size above the limits or a pixel
  /// format that is not read (CMYK, half floats), Error(io).
  PictureShape shape(std::size_t page = 0);

  /// The pixels of one page. Throws as shape() does, Error(bad_data) for a truncated or damaged
  /// picture, Error(out_of_memory). A file that is much too small for the size that its header
  /// claims is refused before any memory is taken for it.
  Frame read(std::size_t page = 0);

  /// The same, and in the same go its colours as they stand in the file (8 bit of a palette);
  /// `colours` is left empty where the page is grey. Throws as read() does.
  Frame read(std::size_t page, Colours& colours);

  /// Internals that each format's own source file defines (pictures/decoder.hpp).
  class Source;
  class Decoder;

 private:
  void open();

  PictureOptions options_;
  std::unique_ptr<Source> source_;
  std::unique_ptr<Decoder> decoder_;
  PictureFormat format_ = PictureFormat::png;
};

/// PictureFile(path).page_count().
std::size_t count_pages(const std::filesystem::path& path);

/// PictureFile(path).read(page): for one picture; keep a PictureFile open to read several pages.
Frame read_picture(const std::filesystem::path& path, std::size_t page = 0);

/// Writes a grey picture in the format that the file's ending names (.png, .tif, .tiff, .pgm; in
/// any case), 8 or 16 bit as the frame is, whole or not at all. Throws Error(bad_argument) for
/// another ending or an empty frame, Error(io) with the system's reason.
void write_picture(const std::filesystem::path& path, const Frame& frame);

/// The same with the colours of that picture (.png, .tif, .tiff); a grey picture where they are
/// empty. Throws as the other, and Error(bad_argument) for colours of another size or depth.
void write_picture(const std::filesystem::path& path, const Frame& frame, const Colours& colours);

}  // namespace fathom
