// SPDX-License-Identifier: Apache-2.0
#include "depth/scoring.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "depth/halve.hpp"
#include "depth/interruption.hpp"

namespace fathom::depth {

/// A node's window falls between pixels, so its powers are those of three whole windows, weighed: the
/// nearest one and its neighbours on that side along each axis. Powers change evenly from one to the
/// next, where pixels between pixels would lack what is fine.
constexpr std::size_t kAround = 3;
struct Scoring::Around {
  std::array<Window, kAround> windows;
  std::array<double, kAround> weights;
};

namespace {

using Around = Scoring::Around;

MetricSpec metric() {
  return {.transform = Transform::fft,
          .n = kSide,
          .taper = Taper::hann(),
          .power = true,
          .measure = Measure::rings,
          .rings = kRings};
}

/// Values that one call writes: as many windows as keep a device busy, and little memory.
constexpr std::size_t kWindowsAtOnce = 1 << 16;

/// What white noise of variance 1 puts into every ring: (SUM w^2)^2 / N^4 of a raised cosine, whose
/// squares have a mean of 3/8.
constexpr double kWhitePower = 0.375 * 0.375 / (kSide * kSide);

/// Mean square of a sample of the pixels.
double mean_square_of(const Frame& frame) {
  constexpr int kEvery = 5;
  double sum = 0;
  std::size_t count = 0;
  for (int y = 0; y < frame.height_px(); y += kEvery) {
    for (int x = y % kEvery; x < frame.width_px(); x += kEvery, ++count)
      sum += std::pow(static_cast<double>(frame.at(x, y)), 2);
  }
  return sum / static_cast<double>(count);
}

/// Where the windows of nodes lie in a frame; they may cross the edge.
class Placing {
 public:
  Placing(const Level& level, const Similarity& place)
      : level_(level),
        place_(place),
        cosine_(place.scale * std::cos(place.angle_rad)),
        sine_(place.scale * std::sin(place.angle_rad)),
        centre_x_((level.width_px * level.scale() - 1) / 2.0),
        centre_y_((level.height_px * level.scale() - 1) / 2.0) {}

  Around operator()(std::size_t node) const {
    const int column = static_cast<int>(node % level_.columns);
    const int row = static_cast<int>(node / level_.columns);
    const double x = level_.first_px() + column * level_.pitch_px() - centre_x_;
    const double y = level_.first_px() + row * level_.pitch_px() - centre_y_;
    const double left = corner(centre_x_ + cosine_ * x - sine_ * y + place_.dx_px);
    const double top = corner(centre_y_ + sine_ * x + cosine_ * y + place_.dy_px);
    const double near_x = std::floor(left + 0.5), near_y = std::floor(top + 0.5);
    const double off_x = left - near_x, off_y = top - near_y;
    const int i = static_cast<int>(near_x), j = static_cast<int>(near_y);
    const int beside = std::abs(off_x) < kNothing ? i : off_x < 0 ? i - 1 : i + 1;
    const int below = std::abs(off_y) < kNothing ? j : off_y < 0 ? j - 1 : j + 1;
    return {{Window{i, j, kSide}, Window{beside, j, kSide}, Window{i, below, kSide}},
            {1 - std::abs(off_x) - std::abs(off_y), std::abs(off_x), std::abs(off_y)}};
  }

 private:
  static constexpr double kNothing = 1.0 / 64;  // px

  /// Of a window round this point, in pixels of the level; somewhere outside where it is far away.
  double corner(double centre_px) const {
    constexpr double kFar = 1 << 30;
    return std::clamp((centre_px - level_.first_px()) / level_.scale(), -kFar, kFar);
  }

  const Level& level_;
  Similarity place_;
  double cosine_, sine_, centre_x_, centre_y_;
};

/// At the very edge a neighbour is the nearest window itself; where that is outside too, nobody asks.
Window moved_inside(Window window, const Level& level) {
  window.x = std::clamp(window.x, 0, level.width_px - kSide);
  window.y = std::clamp(window.y, 0, level.height_px - kSide);
  return window;
}

Windows grid_of(const Level& level) {
  return WindowGrid(level.width_px, level.height_px, Window{0, 0, kSide}, level.stride_px);
}

}  // namespace

Scoring::Scoring(const OpenDevice& open, std::vector<Level> levels, std::size_t frames)
    : levels_(std::move(levels)), halved_(levels_.back().halvings + 1) {
  std::size_t most = 0;
  for (const Level& level : levels_) {
    stores_.emplace_back(level.nodes() * kRings, frames);
    scorers_.push_back(
        std::make_unique<Scorer>(open(metric(), level.nodes()), metric(), grid_of(level)));
    most = std::max(most, level.nodes());
  }
  values_.resize(std::min(most, kWindowsAtOnce) * kRings);
}

int Scoring::device_threads() const { return scorers_.front()->selection().device->threads(); }

void Scoring::add(std::size_t frame, const Frame& grey, const Seen& seen, int threads) {
  if (first_square_ == 0) first_square_ = mean_square_of(grey);
  fineness_ = grey.depth() == Depth::bits8 ? kFineness : 1;
  Frame halved;
  std::size_t level = 0;
  for (int halvings = 0; level < levels_.size(); ++halvings) {
    const Frame& picture = halvings == 0 ? grey : halved;
    if (levels_[level].halvings == halvings) add_level(level++, frame, picture, seen);
    if (level < levels_.size()) halved = halve(picture, halved_[halvings], threads);
  }
}

void Scoring::clear() {
  scorers_.clear();
  stores_.clear();
  halved_.clear();
}

void Scoring::add_level(std::size_t level, std::size_t frame, const Frame& picture,
                        const Seen& seen) {
  const double grey = levels_[level].halvings > 0 ? fineness_ : 1;
  const double unit =
      std::max(first_square_, 1.0) * grey * grey * kWhitePower / (seen.gain * seen.gain);
  if (seen.place == Similarity{}) return add_grid(level, frame, picture, unit);
  const Placing around(levels_[level], seen.place);
  const std::size_t nodes = levels_[level].nodes();
  const std::size_t at_once =
      std::max<std::size_t>(std::min(kWindowsAtOnce, scorers_[level]->batch()) / kAround, 1);
  std::vector<Around> some;
  for (std::size_t first = 0; first < nodes; first += some.size()) {
    look_for_interruption();
    some.resize(std::min(at_once, nodes - first));
    for (std::size_t i = 0; i < some.size(); ++i) some[i] = around(first + i);
    score(level, picture, some);
    stores_[level].put(frame, first * kRings, std::span(values_).first(some.size() * kRings), unit);
    for (std::size_t i = 0; i < some.size(); ++i) {
      const bool is_there =
          fits(some[i].windows[0], levels_[level].width_px, levels_[level].height_px);
      if (!is_there) stores_[level].forget(frame, (first + i) * kRings, kRings);
    }
  }
}

void Scoring::add_grid(std::size_t level, std::size_t frame, const Frame& picture, double unit) {
  const std::size_t nodes = levels_[level].nodes();
  for (std::size_t first = 0; first < nodes; first += kWindowsAtOnce) {
    look_for_interruption();
    const std::size_t count = std::min(kWindowsAtOnce, nodes - first) * kRings;
    const std::span<double> values(values_.data(), count);
    scorers_[level]->score(picture, first, values);
    stores_[level].put(frame, first * kRings, values, unit);
  }
}

void Scoring::score(std::size_t level, const Frame& picture, std::span<const Around> nodes) {
  std::vector<Window> windows;
  windows.reserve(nodes.size() * kAround);
  for (const Around& around : nodes) {
    for (const Window& window : around.windows)
      windows.push_back(moved_inside(window, levels_[level]));
  }
  values_.resize(std::max(values_.size(), windows.size() * kRings));
  scorers_[level]->score(picture, windows, std::span(values_).first(windows.size() * kRings));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double* const from = values_.data() + i * kAround * kRings;
    double mixed[kRings] = {};
    for (std::size_t k = 0; k < kAround; ++k) {
      for (int ring = 0; ring < kRings; ++ring)
        mixed[ring] += nodes[i].weights[k] * from[k * kRings + ring];
    }
    std::copy_n(mixed, kRings, values_.data() + i * kRings);
  }
}

}  // namespace fathom::depth
