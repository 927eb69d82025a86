// SPDX-License-Identifier: Apache-2.0
#include "serve/picture_feed.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "pictures/raster.hpp"

namespace fathom::serve {
namespace {

/// The mean of each block of `times` x `times` pixels, in 8 bit.
std::vector<std::uint8_t> narrowed(const Frame& frame, int times, int most_grey) {
  const int width = frame.width_px() / times, height = frame.height_px() / times;
  std::vector<std::uint8_t> pixels;
  pixels.reserve(static_cast<std::size_t>(width) * height);
  const auto whole = static_cast<std::uint64_t>(times) * times * most_grey;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::uint64_t sum = 0;
      for (int row = y * times; row < (y + 1) * times; ++row) {
        for (int column = x * times; column < (x + 1) * times; ++column)
          sum += frame.at(column, row);
      }
      pixels.push_back(static_cast<std::uint8_t>(std::min<std::uint64_t>(255 * sum / whole, 255)));
    }
  }
  return pixels;
}

std::string encoded(const Frame& frame, int times, int most_grey) {
  constexpr int kQuality = 80;
  if (times == 1 && frame.depth() == Depth::bits8 &&
      frame.stride_bytes() == static_cast<std::size_t>(frame.width_px()))
    return encode_jpeg(raster_of(frame), kQuality);
  const std::vector<std::uint8_t> pixels = narrowed(frame, times, most_grey);
  return encode_jpeg(raster_of(pixels.data(), frame.width_px() / times, frame.height_px() / times),
                     kQuality);
}

}  // namespace

std::shared_ptr<const std::string> Picture::jpeg(int widest_px) const {
  const int narrowest = std::min(frame_.width_px(), frame_.height_px());
  const int wished = widest_px > 0 ? (frame_.width_px() + widest_px - 1) / widest_px : 1;
  const int times = std::clamp(wished, 1, narrowest);
  const std::lock_guard lock(mutex_);
  auto& made = jpegs_[times];
  if (!made) made = std::make_shared<const std::string>(encoded(frame_, times, most_grey_));
  return made;
}

void PictureFeed::show(const Frame& frame, std::optional<double> position, bool is_settled,
                       int most_grey) {
  Frame copy = frame.clone();
  const std::lock_guard lock(mutex_);
  auto picture = std::make_shared<Picture>(std::move(copy), ++count_, most_grey);
  picture->position = position;
  picture->is_settled = is_settled;
  newest_ = std::move(picture);
  shown_.notify_all();
}

std::shared_ptr<const Picture> PictureFeed::next(std::uint64_t seen,
                                                 std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  const auto is_new = [&] { return newest_ && newest_->number() > seen; };
  shown_.wait_for(lock, timeout, [&] { return is_new() || is_closed_; });
  return is_new() ? newest_ : nullptr;
}

std::shared_ptr<const Picture> PictureFeed::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

int PictureFeed::watchers() const {
  const std::lock_guard lock(mutex_);
  return watchers_;
}

void PictureFeed::add_watcher(int change) {
  const std::lock_guard lock(mutex_);
  watchers_ += change;
}

void PictureFeed::close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  shown_.notify_all();
}

}  // namespace fathom::serve
