// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/replay/stack.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <system_error>

#include "engine/error.hpp"
#include "engine/file.hpp"

namespace fathom::replay {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kLargestManifest = std::uintmax_t{64} << 20;
constexpr std::size_t kCacheBytes = std::size_t{256} << 20;
constexpr double kCoarseSamples = 128;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Takes the digits at the front of a text; returns them without leading zeros.
std::string_view take_number(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  std::string_view digits = text.substr(0, end);
  text.remove_prefix(end);
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

bool is_picture_name(const fs::path& path) {
  constexpr std::array<std::string_view, 8> kEndings = {".png",  ".jpg", ".jpeg", ".tif",
                                                        ".tiff", ".pgm", ".ppm",  ".pnm"};
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return path.filename().string().front() != '.' &&
         std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

/// The folder's files, in natural order of their names.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::error_code problem;
  std::vector<fs::path> files;
  for (fs::directory_iterator it(folder, problem), end; !problem && it != end;
       it.increment(problem)) {
    std::error_code ignored;
    if (!it->is_directory(ignored)) files.push_back(it->path());
  }
  if (problem) {
    throw Error(ErrorCode::io,
                fmt::format("cannot read {}: {}", folder.string(), problem.message()));
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

std::string label(const fs::path& file, std::size_t page) {
  return page == 0 ? file.string() : fmt::format("{} page {}", file.string(), page);
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view number_a = take_number(a);
      const std::string_view number_b = take_number(b);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
    } else {
      if (a.front() != b.front()) {
        return static_cast<unsigned char>(a.front()) < static_cast<unsigned char>(b.front());
      }
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() != b.empty()) return a.empty();
  return whole_a < whole_b;  // x_01 and x_1 differ by zeros only
}

RecordedStack::RecordedStack(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) {
    list_pages(path);
  } else if (fs::exists(path / kManifestName, ignored)) {
    list_manifest(path);
  } else {
    list_folder(path);
  }
  check_headers(path);
  std::sort(frames_.begin(), frames_.end(),
            [](const Entry& a, const Entry& b) { return a.position < b.position; });
  for (const Entry& entry : frames_) positions_.push_back(entry.position);
  find_resolution();
}

void RecordedStack::list_manifest(const fs::path& folder) {
  const fs::path path = folder / kManifestName;
  const Manifest manifest = parse_manifest(read_file(path, kLargestManifest), path.string());
  unit_ = manifest.unit;
  manifest_spacing_ = manifest.coarse_spacing;
  for (const ManifestEntry& entry : manifest.entries) {
    const fs::path file = folder / entry.file;
    std::error_code ignored;
    if (!fs::exists(file, ignored)) {
      throw Error(ErrorCode::bad_data, fmt::format("{} line {}: there is no file {}", path.string(),
                                                   entry.line, file.string()));
    }
    frames_.push_back({file, entry.page, entry.position, entry.line});
  }
}

void RecordedStack::list_folder(const fs::path& folder) {
  for (const fs::path& file : files_in(folder)) {
    if (is_picture_name(file)) list_pages(file);
  }
  if (frames_.empty()) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} has no pictures in it (.png, .jpg, .tif, .pgm)", folder.string()));
  }
}

void RecordedStack::list_pages(const fs::path& file) {
  const std::size_t count = file_of({file}).page_count();
  for (std::size_t page = 0; page < count; ++page) {
    frames_.push_back({file, page, static_cast<double>(frames_.size())});
  }
}

void RecordedStack::check_headers(const fs::path& path) {
  for (const Entry& entry : frames_) {
    PictureFile& file = file_of(entry);
    if (entry.page >= file.page_count()) {
      throw Error(ErrorCode::bad_data,
                  fmt::format("{} line {}: {} has {} pages, 0 to {}, and no page {}",
                              (path / kManifestName).string(), entry.line, entry.file.string(),
                              file.page_count(), file.page_count() - 1, entry.page));
    }
    const PictureShape shape = file.shape(entry.page);
    if (&entry == &frames_.front()) shape_ = shape;
    if (shape == shape_) continue;
    const Entry& first = frames_.front();
    throw Error(ErrorCode::bad_data,
                fmt::format("the frames of a stack must be alike, but {} is {} and {} is {}",
                            label(first.file, first.page), to_string(shape_),
                            label(entry.file, entry.page), to_string(shape)));
  }
}

void RecordedStack::find_resolution() {
  for (std::size_t i = 1; i < positions_.size(); ++i) {
    const double gap = positions_[i] - positions_[i - 1];
    resolution_ = i == 1 ? gap : std::min(resolution_, gap);
  }
}

double RecordedStack::coarse_spacing() const {
  if (manifest_spacing_) return *manifest_spacing_;
  if (static_cast<double>(frames_.size()) <= kCoarseSamples) return resolution_;
  const double travel = positions_.back() - positions_.front();
  return std::ceil(travel / kCoarseSamples / resolution_) * resolution_;
}

std::size_t RecordedStack::index_of(double position) const {
  const auto found = std::lower_bound(positions_.begin(), positions_.end(), position);
  return static_cast<std::size_t>(found - positions_.begin());
}

PictureFile& RecordedStack::file_of(const Entry& entry) {
  if (!open_file_ || open_file_->first != entry.file) {
    open_file_.emplace(entry.file, PictureFile(entry.file));
  }
  return open_file_->second;
}

std::shared_ptr<const Frame> RecordedStack::frame(std::size_t index) {
  const auto known = std::find_if(cache_.begin(), cache_.end(),
                                  [&](const auto& cached) { return cached.first == index; });
  if (known != cache_.end()) {
    cache_.splice(cache_.begin(), cache_, known);
    return cache_.front().second;
  }
  const Entry& entry = frames_[index];
  Frame frame = file_of(entry).read(entry.page);
  const PictureShape shape{frame.width_px(), frame.height_px(), frame.depth()};
  if (shape != shape_) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} was {} when the stack was opened and is {} now",
                            label(entry.file, entry.page), to_string(shape_), to_string(shape)));
  }
  cache_.emplace_front(index, std::make_shared<const Frame>(std::move(frame)));
  const std::size_t frame_bytes =
      cache_.front().second->stride_bytes() * static_cast<std::size_t>(shape.height_px);
  const std::size_t most = std::max<std::size_t>(1, kCacheBytes / frame_bytes);
  while (cache_.size() > most) cache_.pop_back();
  return cache_.front().second;
}

}  // namespace fathom::replay
