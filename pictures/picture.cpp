// SPDX-License-Identifier: Apache-2.0
#include "pictures/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <new>
#include <optional>
#include <system_error>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "pictures/decoder.hpp"
#include "pictures/raster.hpp"

namespace fathom {
namespace {

std::optional<PictureFormat> format_of(std::string_view start) {
  using namespace std::string_view_literals;
  if (start.starts_with("\x89PNG\r\n\x1a\n"sv)) return PictureFormat::png;
  if (start.starts_with("\xff\xd8\xff"sv)) return PictureFormat::jpeg;
  for (const std::string_view magic : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv}) {
    if (start.starts_with(magic)) return PictureFormat::tiff;
  }
  const bool is_pnm = start.size() > 2 && start[0] == 'P' &&
                      "2356"sv.find(start[1]) != std::string_view::npos &&
                      "# \t\r\n\v\f"sv.find(start[2]) != std::string_view::npos;
  if (is_pnm) return PictureFormat::pnm;
  return std::nullopt;
}

/// Runs a decoder; what the disk or the memory refused comes out as such and not as a damaged
/// picture.
template <class Decode>
auto decode(const PictureFile::Source& source, Decode run) {
  try {
    return run();
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory,
                fmt::format("cannot read {}: not enough memory for its pixels", source.name()));
  } catch (const Error&) {
    if (source.io_error() == 0) throw;
    throw Error(ErrorCode::io, fmt::format("cannot read {}: {}", source.name(),
                                           std::generic_category().message(source.io_error())));
  }
}

void require_page(const PictureFile& file, const std::string& name, std::size_t page) {
  const std::size_t count = file.page_count();
  const auto& damaged = file.contents().damaged;
  if (const auto found = damaged.find(page); found != damaged.end()) {
    pictures::throw_damaged(count == 1 ? name : fmt::format("{} page {}", name, page),
                            found->second);
  }
  if (page < count) return;
  throw Error(ErrorCode::out_of_bounds,
              count == 1 ? fmt::format("{} page {}: the file has one page, 0", name, page)
                         : fmt::format("{} page {}: the file has {} pages, 0 to {}", name, page,
                                       count, count - 1));
}

}  // namespace

std::string to_string(const PictureShape& shape) {
  return fmt::format("{} x {} px, {} bit", shape.width_px, shape.height_px,
                     static_cast<int>(shape.depth));
}

PictureFile::PictureFile(const std::filesystem::path& path, const PictureOptions& options)
    : options_(options), source_(std::make_unique<Source>(path)) {
  open();
}

PictureFile::PictureFile(std::string_view bytes, std::string name, const PictureOptions& options)
    : options_(options), source_(std::make_unique<Source>(bytes, std::move(name))) {
  open();
}

PictureFile::PictureFile(PictureFile&&) noexcept = default;
PictureFile& PictureFile::operator=(PictureFile&& other) noexcept {
  decoder_ = std::move(other.decoder_);  // the old decoder goes before the source that it reads
  source_ = std::move(other.source_);
  options_ = other.options_;
  format_ = other.format_;
  return *this;
}
PictureFile::~PictureFile() = default;

void PictureFile::open() {
  if (source_->size() == 0) {
    throw Error(ErrorCode::bad_data, fmt::format("cannot read {}: it is empty", source_->name()));
  }
  decode(*source_, [&] {
    char start[8];
    const std::size_t count = source_->read(0, start, sizeof start);
    const auto format = format_of({start, count});
    if (!format) {
      throw Error(ErrorCode::bad_data,
                  fmt::format("{} is no PNG, JPEG, TIFF or PGM picture", source_->name()));
    }
    format_ = *format;
    switch (format_) {
      case PictureFormat::png:
        decoder_ = pictures::open_png(*source_, options_);
        break;
      case PictureFormat::jpeg:
        decoder_ = pictures::open_jpeg(*source_, options_);
        break;
      case PictureFormat::tiff:
        decoder_ = pictures::open_tiff(*source_, options_);
        break;
      case PictureFormat::pnm:
        decoder_ = pictures::open_pnm(*source_, options_);
        break;
    }
  });
}

const PictureContents& PictureFile::contents() const { return decoder_->contents(); }

PictureShape PictureFile::shape(std::size_t page) {
  require_page(*this, source_->name(), page);
  return decode(*source_, [&] { return decoder_->shape(page); });
}

bool PictureFile::is_colour(std::size_t page) {
  require_page(*this, source_->name(), page);
  return decode(*source_, [&] { return decoder_->is_colour(page); });
}

Frame PictureFile::read(std::size_t page) {
  require_page(*this, source_->name(), page);
  return decode(*source_, [&] { return decoder_->read(page, nullptr); });
}

Frame PictureFile::read(std::size_t page, Colours& colours) {
  require_page(*this, source_->name(), page);
  colours = {};
  return decode(*source_, [&] { return decoder_->read(page, &colours); });
}

std::size_t count_pages(const std::filesystem::path& path) {
  return PictureFile(path).page_count();
}

Frame read_picture(const std::filesystem::path& path, std::size_t page) {
  return PictureFile(path).read(page);
}

void write_picture(const std::filesystem::path& path, const Frame& frame) {
  write_picture(path, frame, {});
}

void write_picture(const std::filesystem::path& path, const Frame& frame, const Colours& colours) {
  if (frame.empty()) {
    throw Error(ErrorCode::bad_argument, fmt::format("cannot write {}: no pixels", path.string()));
  }
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool is_tiff = ending == ".tif" || ending == ".tiff";
  if (ending == ".pgm" && colours.empty()) return write_file(path, pictures::encode_pgm(frame));
  if (ending != ".png" && !is_tiff) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("cannot write {}: the name must end in {}", path.string(),
                            colours.empty() ? ".png, .tif, .tiff or .pgm" : ".png, .tif or .tiff"));
  }
  const Frame dense = frame.clone();  // without gaps between rows
  const Raster raster =
      colours.empty() ? raster_of(dense) : raster_of(colours, dense.width_px(), dense.height_px());
  write_file(path, is_tiff ? encode_tiff(raster) : encode_png(raster, PngEffort::small));
}

}  // namespace fathom
