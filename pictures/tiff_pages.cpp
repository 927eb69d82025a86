// SPDX-License-Identifier: Apache-2.0
#include "pictures/tiff_pages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "engine/error.hpp"
#include "pictures/stack_text.hpp"

namespace fathom::pictures {
namespace {

constexpr std::uint32_t kMetaMorphPlanes = 33629;  // UIC2Tag: as many entries as planes

/// How the pixels of the current directory lie in the file.
struct Chunks {
  std::vector<std::uint64_t> offsets, sizes;  // of each strip or tile
  bool is_plain = false;                      // uncompressed strips, which follow each other
  std::uint64_t bytes() const { return offsets.back() + sizes.back() - offsets.front(); }
};

std::vector<std::uint64_t> numbers(TIFF* tiff, std::uint32_t tag, std::size_t count) {
  const std::uint64_t* values = nullptr;
  if (TIFFGetField(tiff, tag, &values) == 0 || values == nullptr) return {};
  return {values, values + count};
}

/// The bytes that an uncompressed strip or tile needs; its directory may claim more.
std::uint64_t needed_bytes(TIFF* tiff, std::size_t chunk) {
  if (TIFFIsTiled(tiff) != 0) return static_cast<std::uint64_t>(TIFFTileSize64(tiff));
  std::uint32_t height = 0, rows = 0;
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &rows);
  rows = std::min(rows, height);
  const std::uint64_t strips = rows > 0 ? (std::uint64_t{height} + rows - 1) / rows : 1;
  const std::uint64_t top = chunk % strips * rows;
  return TIFFVStripSize64(tiff,
                          static_cast<std::uint32_t>(std::min<std::uint64_t>(rows, height - top)));
}

/// Empty where libtiff knows of no pixels.
Chunks chunks_of(TIFF* tiff, bool is_uncompressed) {
  const bool tiled = TIFFIsTiled(tiff) != 0;
  const std::size_t count = tiled ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
  Chunks chunks;
  chunks.offsets = numbers(tiff, tiled ? TIFFTAG_TILEOFFSETS : TIFFTAG_STRIPOFFSETS, count);
  chunks.sizes = numbers(tiff, tiled ? TIFFTAG_TILEBYTECOUNTS : TIFFTAG_STRIPBYTECOUNTS, count);
  if (chunks.offsets.size() != chunks.sizes.size() || count == 0) return {};
  if (!is_uncompressed) return chunks;
  chunks.is_plain = !tiled;
  for (std::size_t i = 0; i < count; ++i) {
    chunks.sizes[i] = chunks.sizes[i] == 0 ? 0 : needed_bytes(tiff, i);
    if (i > 0 && chunks.offsets[i] != chunks.offsets[i - 1] + chunks.sizes[i - 1])
      chunks.is_plain = false;
  }
  return chunks;
}

/// Why not all pixels are in the file, or empty. shift: of a plane behind the first.
std::string missing_part(const TiffFile& file, const Chunks& chunks, std::uint64_t shift = 0) {
  const char* const what = TIFFIsTiled(file.get()) != 0 ? "tile" : "strip";
  const std::size_t count = chunks.offsets.size();
  if (count == 0) return fmt::format("it has no {}s of pixels", what);
  for (std::size_t i = 0; i < count; ++i) {
    if (chunks.offsets[i] == 0 || chunks.sizes[i] == 0)
      return fmt::format("{} {} of {} is missing", what, i + 1, count);
    const std::uint64_t size = file.source().size();
    const std::uint64_t start = chunks.offsets[i] + shift;
    if (start > size || chunks.sizes[i] > size - start)
      return fmt::format("{} {} of {} lies beyond the end of the file", what, i + 1, count);
  }
  return {};
}

/// A whole number of so many bytes, in the byte order of the file; 0 beyond its end.
std::uint64_t number_at(const TiffFile& file, std::uint64_t offset, std::size_t bytes) {
  unsigned char order = 0, digits[8] = {};
  file.source().read(0, &order, 1);
  if (file.source().read(offset, digits, bytes) != bytes) return 0;
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i)
    value = value << 8 | digits[order == 'M' ? i : bytes - 1 - i];
  return value;
}

/// Where the directory behind one begins, as that one says; 0: it is the last.
std::uint64_t next_directory(const TiffFile& file, std::uint64_t offset) {
  constexpr std::uint64_t kBig = 43;  // classic files have 42
  const bool is_big = number_at(file, 2, 2) == kBig;
  const std::size_t count_bytes = is_big ? 8 : 2, entry_bytes = is_big ? 20 : 12;
  const std::uint64_t entries = number_at(file, offset, count_bytes);
  return number_at(file, offset + count_bytes + entries * entry_bytes, is_big ? 8 : 4);
}

/// Samples of a pixel that are no colours and no alpha are pictures: how many, or 1.
std::uint16_t pictures_in_samples(const TiffFile& file) {
  const std::uint32_t photometric = file.field(TIFFTAG_PHOTOMETRIC);
  const auto samples = static_cast<std::uint16_t>(file.field(TIFFTAG_SAMPLESPERPIXEL));
  if (photometric != PHOTOMETRIC_MINISBLACK && photometric != PHOTOMETRIC_MINISWHITE) return 1;
  std::uint16_t extras = 0;
  const std::uint16_t* kinds = nullptr;
  const bool is_told = TIFFGetField(file.get(), TIFFTAG_EXTRASAMPLES, &extras, &kinds) != 0;
  const bool has_alpha = is_told && extras == 1 && kinds[0] != EXTRASAMPLE_UNSPECIFIED;
  return has_alpha ? 1 : std::max<std::uint16_t>(samples, 1);
}

class PageList {
 public:
  explicit PageList(TiffFile& file) : file_(file) {}

  TiffPages list() {
    walk();
    if (list_.pages.empty()) refuse_previews();
    describe();
    list_.contents.pages = list_.pages.size();
    list_.contents.words = file_.words();
    return std::move(list_);
  }

 private:
  TIFF* tiff() const { return file_.get(); }

  void walk() {
    do {
      add_directory();
      if (TIFFLastDirectory(tiff()) != 0) return;
      file_.forget_trouble();
    } while (TIFFReadDirectory(tiff()) != 0);
    // The recording was cut off: there is a page more, and nobody knows what it shows.
    is_cut_ = true;
    add({}, fmt::format("its directory cannot be read: {}", file_.reason()));
  }

  void add_directory() {
    std::uint32_t kind = 0;
    TIFFGetFieldDefaulted(tiff(), TIFFTAG_SUBFILETYPE, &kind);
    const bool is_preview = (kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) != 0;
    first_page_of_directory_.push_back(is_preview ? PictureStack::kMissing : list_.pages.size());
    if (first_page_of_directory_.size() == 1) note_first_directory();
    if (is_preview) {
      ++list_.contents.previews;
      return;
    }
    add_pages();
  }

  /// What describes the whole file stands in the first directory.
  void note_first_directory() {
    const char* text = nullptr;
    if (TIFFGetField(tiff(), TIFFTAG_IMAGEDESCRIPTION, &text) != 0 && text != nullptr)
      description_ = text;
    std::uint32_t count = 0;
    const void* ignored = nullptr;
    if (TIFFGetField(tiff(), kMetaMorphPlanes, &count, &ignored) != 0) hidden_planes_ = count;
  }

  void add_pages() {
    const bool is_uncompressed = file_.field(TIFFTAG_COMPRESSION) == COMPRESSION_NONE;
    const Chunks chunks = chunks_of(tiff(), is_uncompressed);
    std::string problem = missing_part(file_, chunks);
    if (problem.empty() && file_.in_trouble()) problem = file_.reason();
    const std::uint16_t samples = pictures_in_samples(file_);
    const std::uint64_t directory = TIFFCurrentDirOffset(tiff());
    for (std::uint16_t sample = 0; sample < samples; ++sample) add({directory, 0, sample}, problem);
    if (samples > 1) list_.contents.samples_as_pages = samples;
    if (first_page_of_directory_.size() == 1) first_chunks_ = chunks;
  }

  void add(const TiffPage& page, const std::string& problem) {
    if (!problem.empty()) list_.contents.damaged[list_.pages.size()] = problem;
    list_.pages.push_back(page);
  }

  [[noreturn]] void refuse_previews() const {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} holds nothing but a preview in a form that is read here, as raw "
                            "files of cameras (DNG, NEF) do; save it as 8- or 16-bit TIFF or PNG",
                            file_.name()));
  }

  /// What the file says of its planes, and those that have no directory of their own.
  void describe() {
    std::optional<DescribedStack> told = parse_imagej(description_);
    if (!told) told = parse_shaped(description_);
    if (told && is_cut_ && lie_together(told->images)) keep_first_page();
    if (told && list_.pages.size() == 1) hidden_planes_ = told->images;
    add_hidden_planes();
    if (told) {
      if (told->stack.pages.size() > 1) list_.contents.stacks.push_back(told->stack);
      leave_out_missing();
      return;
    }
    if (!is_ome(description_)) return;
    const std::string own_name = std::filesystem::path(file_.name()).filename().string();
    const auto stacks = parse_ome(description_, own_name, first_page_of_directory_);
    list_.contents.is_description_damaged = !stacks;
    if (stacks) list_.contents.stacks = *stacks;
    leave_out_missing();
  }

  /// Whether there is room for all planes, one behind the other, between the first one's directory
  /// and the next: ImageJ and tifffile write them so.
  bool lie_together(std::uint64_t planes) const {
    if (first_chunks_.offsets.empty() || !first_chunks_.is_plain || planes < 2) return false;
    const std::uint64_t next = next_directory(file_, list_.pages.front().directory);
    const std::uint64_t first = first_chunks_.offsets.front(), bytes = first_chunks_.bytes();
    return next > first && bytes > 0 && planes <= (next - first) / bytes;
  }

  /// The directories behind it are lost, but the planes are where the description says.
  void keep_first_page() {
    list_.pages.resize(1);
    list_.contents.damaged.erase(list_.contents.damaged.upper_bound(0),
                                 list_.contents.damaged.end());
  }

  /// A description may promise more planes than an aborted recording has.
  void leave_out_missing() {
    for (PictureStack& stack : list_.contents.stacks) {
      for (std::size_t& page : stack.pages) {
        if (page >= list_.pages.size()) page = PictureStack::kMissing;
      }
    }
  }

  /// ImageJ (above 4 GB) and MetaMorph write all planes behind the first, under its directory.
  void add_hidden_planes() {
    if (list_.pages.size() != 1 || hidden_planes_ < 2 || first_chunks_.offsets.empty()) return;
    const std::uint64_t bytes = first_chunks_.bytes();
    if (!first_chunks_.is_plain || bytes == 0)
      refuse_hidden("are not plain pixels one behind the other");
    const TiffPage first = list_.pages.front();
    file_.select(first.directory);
    // A damaged number must not become a list without end: the file's own end is one.
    const std::uint64_t size = file_.source().size(), start = first_chunks_.offsets.front();
    std::uint64_t plane = 1;
    for (; plane < hidden_planes_ && start + plane * bytes < size; ++plane)
      add({first.directory, plane * bytes, 0}, missing_part(file_, first_chunks_, plane * bytes));
    list_.contents.lost = hidden_planes_ - plane;
  }

  [[noreturn]] void refuse_hidden(const char* why) const {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} says that it holds {} planes, but has one directory, and they {}; "
                            "save it as a TIFF stack",
                            file_.name(), hidden_planes_, why));
  }

  TiffFile& file_;
  TiffPages list_;
  std::vector<std::size_t> first_page_of_directory_;  // kMissing for previews
  std::string description_;
  std::uint64_t hidden_planes_ = 1;
  bool is_cut_ = false;  // a directory behind the last that was read is lost
  Chunks first_chunks_;
};

}  // namespace

TiffPages list_pages(TiffFile& file) { return PageList(file).list(); }

}  // namespace fathom::pictures
