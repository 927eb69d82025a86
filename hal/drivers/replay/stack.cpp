// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/replay/stack.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/error.hpp"
#include "hal/drivers/replay/manifest.hpp"
#include "hal/drivers/replay/spacing.hpp"

namespace fathom::replay {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kCacheBytes = std::size_t{256} << 20;

/// Standard deviation of what `level_of` tells of `count` pixels.
template <class LevelOf>
double contrast_of(std::size_t count, LevelOf level_of) {
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto level = static_cast<double>(level_of(i));
    sum += level;
    squares += level * level;
  }
  const double mean = sum / static_cast<double>(count);
  return std::sqrt(std::max(squares / static_cast<double>(count) - mean * mean, 0.0));
}

}  // namespace

RecordedStack::RecordedStack(const fs::path& path, const Wishes& wishes)
    : listing_(list_recording(path, wishes)) {
  check_headers(path);
  std::stable_sort(
      listing_.pictures.begin(), listing_.pictures.end(),
      [](const ListedPicture& a, const ListedPicture& b) { return a.position < b.position; });
  group();
  resolution_ = smallest_gap(positions_);
  look_for_drowned_colour();
}

void RecordedStack::group() {
  const auto& pictures = listing_.pictures;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (i > 0 && pictures[i].position == pictures[i - 1].position) continue;
    positions_.push_back(pictures[i].position);
    first_.push_back(i);
    names_.push_back(pictures[i].name);
  }
  first_.push_back(pictures.size());
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    if (pictures_at(i) > 1) names_[i] += fmt::format(" and {} more", pictures_at(i) - 1);
  }
  if (positions_.size() < pictures.size())
    listing_.findings.push_back(RepeatedPictures{pictures.size(), positions_.size()});
}

/// Grey weighs blue by 0.114: what is faint and blue alone drowns in rounding. Looks at one picture
/// of the middle, where a focus most likely is.
void RecordedStack::look_for_drowned_colour() {
  constexpr double kDrowned = 0.4;
  const ListedPicture& middle = listing_.pictures[listing_.pictures.size() / 2];
  if (listing_.options.colour != Colour::luma || !file_of(middle).is_colour(middle.page)) return;
  try {
    Colours all;
    const Frame luma = file_of(middle).read(middle.page, all);
    const auto width = static_cast<std::size_t>(luma.width_px());
    const std::size_t count = width * static_cast<std::size_t>(luma.height_px());
    const double grey = contrast_of(count, [&](std::size_t i) {
      return luma.at(static_cast<int>(i % width), static_cast<int>(i / width));
    });
    constexpr std::array<char, 3> kLetters = {'r', 'g', 'b'};
    DrownedColour best{.colour = 'g', .part = 1};
    for (std::size_t c = 0; c < kLetters.size(); ++c) {
      const double contrast = contrast_of(count, [&](std::size_t i) -> std::uint32_t {
        return all.bits8.empty() ? all.bits16[3 * i + c] : all.bits8[3 * i + c];
      });
      if (grey < best.part * contrast) best = {kLetters[c], grey / contrast};
    }
    if (best.part < kDrowned) listing_.findings.push_back(best);
  } catch (const Error&) {  // said when the picture is wanted
  }
}

void RecordedStack::check_headers(const fs::path& path) {
  for (const ListedPicture& entry : listing_.pictures) {
    PictureFile& file = file_of(entry);
    if (entry.page >= file.page_count()) {
      throw Error(ErrorCode::bad_data,
                  fmt::format("{} line {}: {} has {} pages, 0 to {}, and no page {}",
                              (path / kManifestName).string(), entry.line, entry.file.string(),
                              file.page_count(), file.page_count() - 1, entry.page));
    }
    const PictureShape shape = file.shape(entry.page);
    if (&entry == &listing_.pictures.front()) shape_ = shape;
    if (shape == shape_) continue;
    const ListedPicture& first = listing_.pictures.front();
    throw Error(ErrorCode::bad_data,
                fmt::format("the frames of a stack must be alike, but {} is {} and {} is {}",
                            label(first), to_string(shape_), label(entry), to_string(shape)));
  }
}

double RecordedStack::coarse_spacing() const {
  return listing_.coarse_spacing.value_or(coarse_spacing_of(positions_));
}

std::size_t RecordedStack::index_of(double position) const {
  const auto found = std::lower_bound(positions_.begin(), positions_.end(), position);
  return static_cast<std::size_t>(found - positions_.begin());
}

std::string RecordedStack::label(const ListedPicture& picture) {
  return picture.page == 0 ? picture.file.string()
                           : fmt::format("{} page {}", picture.file.string(), picture.page);
}

PictureFile& RecordedStack::file_of(const ListedPicture& entry) {
  if (!open_file_ || open_file_->first != entry.file) {
    open_file_.emplace(entry.file, PictureFile(entry.file, listing_.options));
  }
  return open_file_->second;
}

std::shared_ptr<const Frame> RecordedStack::frame(std::size_t index, std::size_t which) {
  index = first_[index] + which;
  const auto known = std::find_if(cache_.begin(), cache_.end(),
                                  [&](const auto& cached) { return cached.first == index; });
  if (known != cache_.end()) {
    cache_.splice(cache_.begin(), cache_, known);
    return cache_.front().second;
  }
  const ListedPicture& entry = listing_.pictures[index];
  Frame frame = file_of(entry).read(entry.page);
  require_shape(entry, frame);
  cache_.emplace_front(index, std::make_shared<const Frame>(std::move(frame)));
  const std::size_t frame_bytes =
      cache_.front().second->stride_bytes() * static_cast<std::size_t>(shape_.height_px);
  const std::size_t most = std::max<std::size_t>(1, kCacheBytes / frame_bytes);
  while (cache_.size() > most) cache_.pop_back();
  return cache_.front().second;
}

void RecordedStack::require_shape(const ListedPicture& entry, const Frame& frame) const {
  const PictureShape shape{frame.width_px(), frame.height_px(), frame.depth()};
  if (shape == shape_) return;
  throw Error(ErrorCode::bad_data, fmt::format("{} was {} when the stack was opened and is {} now",
                                               label(entry), to_string(shape_), to_string(shape)));
}

Frame RecordedStack::read(std::size_t index, std::size_t which, Colours& colours) {
  const ListedPicture& entry = listing_.pictures[first_[index] + which];
  Frame frame = file_of(entry).read(entry.page, colours);
  require_shape(entry, frame);
  return frame;
}

bool RecordedStack::is_colour() {
  const ListedPicture& first = listing_.pictures.front();
  return file_of(first).is_colour(first.page);
}

}  // namespace fathom::replay
