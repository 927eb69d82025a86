// SPDX-License-Identifier: Apache-2.0
#include "pictures/decoder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "engine/error.hpp"
#include "engine/file.hpp"

namespace fathom {

namespace {

/// A pipe has no size, and one that never ends must not eat the memory.
constexpr std::uintmax_t kLargestPipe = std::uintmax_t{1} << 30;

/// A device has no end (/dev/zero) or no beginning (a terminal).
void require_no_device(const std::filesystem::path& path) {
  if (special_kind(path) != "device") return;
  throw Error(ErrorCode::bad_data,
              fmt::format("{} is a device and no picture file", path.string()));
}

}  // namespace

std::size_t most_picture_pixels() {
  constexpr std::size_t kMostMegapixels = 4096;
  const char* const text = std::getenv("FATHOM_MEGAPIXELS");
  std::size_t megapixels = kDefaultMegapixels;
  if (text != nullptr && *text != '\0') {
    const char* const end = text + std::strlen(text);
    const auto [next, problem] = std::from_chars(text, end, megapixels);
    if (problem != std::errc() || next != end || megapixels < 1 || megapixels > kMostMegapixels) {
      throw Error(ErrorCode::bad_argument,
                  fmt::format("FATHOM_MEGAPIXELS is \"{}\"; write a number from 1 to {}", text,
                              kMostMegapixels));
    }
  }
  return megapixels << 20;
}

PictureFile::Source::Source(const std::filesystem::path& path) : name_(path.string()) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    require_no_device(path);
    // A pipe is read once; read_file also says why a missing file or a folder is refused.
    owned_ = read_file(path, kLargestPipe);
    bytes_ = owned_;
    size_ = bytes_.size();
    return;
  }
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) {
    const int problem = errno;
    if (descriptor_ >= 0) ::close(descriptor_);
    throw Error(ErrorCode::io,
                fmt::format("cannot read {}: {}", name_, std::generic_category().message(problem)));
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

PictureFile::Source::Source(std::string_view bytes, std::string name)
    : name_(std::move(name)), bytes_(bytes), size_(bytes.size()) {}

PictureFile::Source::~Source() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::size_t PictureFile::Source::read(std::uint64_t offset, void* to,
                                      std::size_t count) const noexcept {
  if (offset >= size_) return 0;
  count = static_cast<std::size_t>(std::min<std::uint64_t>(count, size_ - offset));
  if (descriptor_ < 0) {
    std::memcpy(to, bytes_.data() + offset, count);
    return count;
  }
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got = ::pread(descriptor_, static_cast<char*>(to) + done, count - done,
                                static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && io_error_ == 0) io_error_ = errno;
    if (got <= 0) break;  // zero: the file was cut short after it was opened
    done += static_cast<std::size_t>(got);
  }
  return done;
}

const PictureContents& PictureFile::Decoder::contents() const {
  static const PictureContents one_page;
  return one_page;
}

namespace pictures {

void throw_damaged(const std::string& name, std::string_view detail) {
  // libtiff ends its messages with a full stop, ours are the middle of a line.
  detail = detail.substr(0, detail.find('\n'));
  while (detail.ends_with('.') || detail.ends_with(' ')) detail.remove_suffix(1);
  throw Error(ErrorCode::bad_data, fmt::format("{} is truncated or damaged: {}", name, detail));
}

PictureShape checked_shape(const std::string& name, std::uint64_t width_px, std::uint64_t height_px,
                           Depth depth) {
  if (width_px == 0 || height_px == 0) {
    throw Error(ErrorCode::bad_data, fmt::format("{} is damaged: its header says {} x {} px", name,
                                                 width_px, height_px));
  }
  if (width_px > kLargestPictureSide || height_px > kLargestPictureSide) {
    throw Error(ErrorCode::bad_data, fmt::format("{} claims {} x {} px; at most {} a side are read",
                                                 name, width_px, height_px, kLargestPictureSide));
  }
  const std::size_t most = most_picture_pixels();
  if (width_px * height_px > most) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} claims {} x {} px, more than {} megapixels (2^20); if it is no "
                            "mistake, set FATHOM_MEGAPIXELS to {} or more",
                            name, width_px, height_px, most >> 20,
                            (width_px * height_px + (1 << 20) - 1) >> 20));
  }
  return {static_cast<int>(width_px), static_cast<int>(height_px), depth};
}

void require_bytes_for(const Source& source, std::uint64_t unpacked_bytes,
                       std::uint64_t most_shrinkage) {
  if (unpacked_bytes / most_shrinkage <= source.size()) return;
  throw_damaged(
      source.name(),
      fmt::format("{} bytes cannot hold the picture that its header claims", source.size()));
}

}  // namespace pictures
}  // namespace fathom
