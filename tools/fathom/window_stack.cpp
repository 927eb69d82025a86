// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/window_stack.hpp"

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "hal/drivers/simulated/random.hpp"

namespace fathom {
namespace {

using simulated::Random;
using simulated::Stream;

/// Numbers that every noisy picture takes some of, from a place of its own: to draw new ones would
/// take longer than all scores.
const std::vector<float>& normal_numbers() {
  static const std::vector<float> numbers = [] {
    constexpr std::size_t kCount = 1U << 20;
    Random random(1, Stream::frame_noise);
    std::vector<float> drawn(kCount);
    for (float& number : drawn) number = static_cast<float>(random.gaussian());
    return drawn;
  }();
  return numbers;
}

double largest_level(Depth depth) { return depth == Depth::bits8 ? 255 : 65535; }

}  // namespace

void WindowStack::add(double position, const Frame& frame, const Window& window) {
  if (frame.depth() != depth_) {
    throw Error(ErrorCode::bad_argument, "the pictures are not all of one depth");
  }
  positions_.push_back(position);
  lights_.push_back(0);
  pixels_.resize(pixels_.size() + static_cast<std::size_t>(n_) * n_);
  for (int y = 0; y < n_; ++y) {
    for (int x = 0; x < n_; ++x)
      at(size() - 1, x, y) = static_cast<std::uint16_t>(frame.at(window.x + x, window.y + y));
  }
}

std::vector<Window> WindowStack::windows() const {
  std::vector<Window> windows;
  for (std::size_t i = 0; i < size(); ++i) windows.push_back({static_cast<int>(i) * n_, 0, n_});
  return windows;
}

Frame WindowStack::frame() const {
  const auto width = static_cast<int>(size()) * n_;
  std::vector<std::uint16_t> wide(pixels_.size());
  for (std::size_t i = 0; i < size(); ++i) {
    for (int y = 0; y < n_; ++y) {
      const auto row = pixels_.begin() + static_cast<std::ptrdiff_t>((i * n_ + y) * n_);
      std::copy_n(row, n_, wide.begin() + static_cast<std::ptrdiff_t>(y) * width + i * n_);
    }
  }
  if (depth_ == Depth::bits16) return Frame(width, n_, std::move(wide));
  return Frame(width, n_, std::vector<std::uint8_t>(wide.begin(), wide.end()));
}

WindowStack WindowStack::with_noise(double deviation, std::uint64_t seed) const {
  const std::vector<float>& numbers = normal_numbers();
  const double most = largest_level(depth_);
  WindowStack noisy = *this;
  const std::size_t count = static_cast<std::size_t>(n_) * n_;
  for (std::size_t i = 0; i < size(); ++i) {
    const std::uint64_t start = simulated::mix(simulated::mix(seed) + i);
    for (std::size_t k = 0; k < count; ++k) {
      std::uint16_t& pixel = noisy.pixels_[i * count + k];
      const double grey = pixel + deviation * numbers[(start + k) % numbers.size()];
      pixel = static_cast<std::uint16_t>(std::lround(std::clamp(grey, 0.0, most)));
    }
  }
  return noisy;
}

WindowStack WindowStack::repeated(std::size_t index, std::size_t times) const {
  WindowStack same(n_, depth_);
  const std::size_t count = static_cast<std::size_t>(n_) * n_;
  const auto first = pixels_.begin() + static_cast<std::ptrdiff_t>(index * count);
  for (std::size_t i = 0; i < times; ++i) {
    same.positions_.push_back(positions_[index]);
    same.lights_.push_back(lights_[index]);
    same.pixels_.insert(same.pixels_.end(), first, first + static_cast<std::ptrdiff_t>(count));
  }
  return same;
}

double repeat_noise(const WindowStack& repeated) {
  if (repeated.size() < 2) return 0;
  const Frame frame = repeated.frame();
  const int n = repeated.n();
  double squares = 0, count = 0;
  for (int x = n; x < frame.width_px(); ++x) {
    for (int y = 0; y < n; ++y) {
      const double step = static_cast<double>(frame.at(x, y)) - frame.at(x - n, y);
      squares += step * step;
      ++count;
    }
  }
  return std::sqrt(squares / count / 2);
}

}  // namespace fathom
