// SPDX-License-Identifier: Apache-2.0
// What the formats have in common: where bytes come from, what a decoder is, and the limits that
// hold before memory is taken.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "pictures/picture.hpp"

namespace fathom {

/// The bytes of a picture file: a file read in place, or a caller's buffer.
class PictureFile::Source {
 public:
  explicit Source(const std::filesystem::path& path);
  Source(std::string_view bytes, std::string name);
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  ~Source();

  const std::string& name() const { return name_; }
  std::uint64_t size() const { return size_; }

  /// Copies up to `count` bytes from `offset`, fewer only at the end or where the system refuses
  /// (see io_error()). Never throws, because the C libraries call it.
  std::size_t read(std::uint64_t offset, void* to, std::size_t count) const noexcept;

  /// errno of the first read that the system refused, or 0.
  int io_error() const { return io_error_; }

 private:
  std::string name_;
  std::string owned_;  // the bytes of what cannot be read twice, a pipe
  std::string_view bytes_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  mutable int io_error_ = 0;
};

/// One format's reader. `page` is below contents().pages, and not damaged.
class PictureFile::Decoder {
 public:
  virtual ~Decoder() = default;
  virtual const PictureContents& contents() const;
  virtual PictureShape shape(std::size_t page) = 0;
  virtual bool is_colour(std::size_t page) = 0;
  /// colours: where those go, or null; left as it is where the page is grey.
  virtual Frame read(std::size_t page, Colours* colours) = 0;
};

namespace pictures {

using Source = PictureFile::Source;
using Decoder = PictureFile::Decoder;

/// The readers, one source file each. The source outlives the decoder.
std::unique_ptr<Decoder> open_png(const Source& source, const PictureOptions& options);
std::unique_ptr<Decoder> open_jpeg(const Source& source, const PictureOptions& options);
std::unique_ptr<Decoder> open_tiff(const Source& source, const PictureOptions& options);
std::unique_ptr<Decoder> open_pnm(const Source& source, const PictureOptions& options);

/// A whole file, grey, of the frame's depth. The other writers are those of raster.hpp.
std::string encode_pgm(const Frame& frame);

/// Throws Error(bad_data) saying that the picture is truncated or damaged, and the library's own
/// word.
[[noreturn]] void throw_damaged(const std::string& name, std::string_view detail);

/// The shape, if the limits of picture.hpp allow it; else throws Error(bad_data).
PictureShape checked_shape(const std::string& name, std::uint64_t width_px, std::uint64_t height_px,
                           Depth depth);

/// Throws Error(bad_data) if the file is too short to hold `unpacked_bytes` when packed by a method
/// that shrinks at most by `most_shrinkage`: a few bytes cannot claim gigabytes.
void require_bytes_for(const Source& source, std::uint64_t unpacked_bytes,
                       std::uint64_t most_shrinkage);

}  // namespace pictures
}  // namespace fathom
