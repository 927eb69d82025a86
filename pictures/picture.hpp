// SPDX-License-Identifier: Apache-2.0
// Picture files to frames, and frames to picture files.
//
// Every picture becomes grey: 8-bit files give Depth::bits8, deeper ones Depth::bits16, with the
// file's own values, not rescaled (PNG of 1, 2 or 4 bits is the exception: it is spread over
// 0..255). Colour becomes grey by BT.601 luma, 0.299 R + 0.587 G + 0.114 B rounded to nearest;
// alpha is ignored.
//
// Read are PNG, JPEG (grey and colour, no CMYK), TIFF (8 and 16 bit unsigned; grey, RGB and
// palette; strips and tiles; uncompressed, LZW, Deflate, PackBits, Zstandard, LZMA and JPEG) and
// PGM/PPM (binary and ASCII, up to 65535).
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "../engine/frame.hpp"

namespace fathom {

/// Formats, told apart by the file's first bytes, never by its name.
enum class PictureFormat { png, jpeg, tiff, pnm };

/// Pictures wider or taller than this are refused: no focus camera makes them, but a damaged header
/// does.
inline constexpr int kLargestPictureSide = 65536;
/// And so are pictures of more pixels than this (2^30).
inline constexpr std::size_t kMostPicturePixels = std::size_t{1} << 30;

/// What a picture's header says.
struct PictureShape {
  int width_px = 0;
  int height_px = 0;
  Depth depth = Depth::bits8;

  bool operator==(const PictureShape&) const = default;
};

/// "2048 x 1536 px, 8 bit", for messages.
std::string to_string(const PictureShape& shape);

/// An open picture file. Pixels are read from the disk when they are asked for, and any page of a
/// TIFF at the same cost, so that a stack larger than the memory can be walked in any order.
class PictureFile {
 public:
  /// Opens a file and reads its first header (of a TIFF, all). Throws Error(io) with the system's
  /// reason, Error(bad_data) if the file is empty, no picture or damaged.
  explicit PictureFile(const std::filesystem::path& path);
  /// The same for bytes in memory, which must outlive this; `name` stands in error messages.
  PictureFile(std::string_view bytes, std::string name);
  PictureFile(PictureFile&&) noexcept;
  PictureFile& operator=(PictureFile&&) noexcept;
  ~PictureFile();

  PictureFormat format() const { return format_; }

  /// How many pictures the file holds: the pages of a TIFF, 1 for everything else.
  std::size_t page_count() const;

  /// Size and depth of one page, 0-based, from its header alone. Throws Error(out_of_bounds) for a
  /// page that is not there, Error(bad_data) for an absurd size or a pixel format that is not read
  /// (floating point, 32 bit, CMYK), Error(io).
  PictureShape shape(std::size_t page = 0);

  /// The pixels of one page. Throws as shape() does, Error(bad_data) for a truncated or damaged
  /// picture, Error(out_of_memory). A file that is much too small for the size that its header
  /// claims is refused before any memory is taken for it.
  Frame read(std::size_t page = 0);

  /// Internals that each format's own source file defines (pictures/decoder.hpp).
  class Source;
  class Decoder;

 private:
  void open();

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

}  // namespace fathom
