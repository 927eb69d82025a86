// SPDX-License-Identifier: Apache-2.0
#include "depth/jumps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom::depth {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// Places along one axis, averaged along the other one, where noise is none of a jump's affair.
class Lines {
 public:
  Lines(const PlaceGrid& grid, Axis axis)
      : length_(axis == Axis::along_rows ? grid.columns : grid.rows),
        lines_(axis == Axis::along_rows ? grid.rows : grid.columns),
        step_(axis == Axis::along_rows ? 1 : static_cast<std::size_t>(grid.columns)),
        next_line_(axis == Axis::along_rows ? static_cast<std::size_t>(grid.columns) : 1),
        place_(grid.place.size(), kUnknown),
        noise_(grid.place.size(), kUnknown) {
    for (int line = 0; line < lines_; ++line) {
      for (int i = 0; i < length_; ++i) average(grid, line, i);
    }
  }

  int length() const { return length_; }
  int lines() const { return lines_; }
  std::size_t at(int line, int i) const { return line * next_line_ + i * step_; }
  /// NaN where nothing is known, and beyond the ends.
  float place(int line, int i) const {
    return i < 0 || i >= length_ ? kUnknown : place_[at(line, i)];
  }
  float noise(int line, int i) const { return noise_[at(line, i)]; }

 private:
  static constexpr int kBeside = 3;  ///< Places to each side that are averaged.

  void average(const PlaceGrid& grid, int line, int i) {
    float place = 0, variance = 0;
    int known = 0, all = 0;
    for (int k = std::max(line - kBeside, 0); k <= std::min(line + kBeside, lines_ - 1); ++k) {
      const std::size_t from = at(k, i);
      ++all;
      if (std::isnan(grid.place[from])) continue;
      place += grid.place[from];
      variance += grid.noise[from] * grid.noise[from];
      ++known;
    }
    if (2 * known <= all) return;
    place_[at(line, i)] = place / static_cast<float>(known);
    noise_[at(line, i)] = std::sqrt(variance / static_cast<float>(known));
  }

  int length_, lines_;
  std::size_t step_, next_line_;
  std::vector<float> place_, noise_;
};

/// By how much the surface jumps at a place, beyond the slopes on both sides of it; 0 where that
/// cannot be told. A surface that bends the same way on both sides jumps nowhere.
struct Jump {
  float height = 0;
  float terms = 0;  ///< Sum of the squared weights of the places that it is made of.
};

/// What one side leaves of a rise. One slope does not tell how the surface bends.
Jump beyond(float rise, float beside) {
  constexpr float kBends = 3;
  const float left = std::abs(rise) - kBends * std::abs(beside);
  return left > 0 ? Jump{std::copysign(left, rise), 26} : Jump{};
}

Jump between(float before, float rise, float after) {
  constexpr float kSteeper = 2;
  const Jump jump{rise - (before + after) / 2, 5};
  // What rises much more beside it is another cliff, or the surface bends.
  if (std::max(std::abs(before), std::abs(after)) < kSteeper * std::abs(rise)) return jump;
  const Jump other = beyond(rise, std::abs(before) < std::abs(after) ? before : after);
  if (std::abs(jump.height) > std::abs(other.height)) return other;
  return {std::copysign(jump.height, rise), jump.terms};
}

Jump jump_at(const Lines& lines, int line, int i, int reach) {
  const int far = 3 * reach;
  const float low = lines.place(line, i - reach), high = lines.place(line, i + reach);
  const float before = low - lines.place(line, i - far);
  const float after = lines.place(line, i + far) - high;
  const float rise = high - low;
  if (std::isnan(rise) || (std::isnan(before) && std::isnan(after))) return {};
  Jump jump;
  if (std::isnan(before) || std::isnan(after)) {
    jump = beyond(rise, std::isnan(before) ? after : before);
  } else {
    jump = between(before, rise, after);
  }
  // Beside a jump the slope of one side holds the whole of it, and what is level seems to jump back.
  constexpr float kRises = 0.5f;
  return rise / jump.height > kRises ? jump : Jump{};
}

Jumps jumps_over(const Lines& lines, int reach, std::size_t places) {
  Jumps jumps{std::vector<float>(places), std::vector<float>(places), std::vector<float>(places)};
  for (int line = 0; line < lines.lines(); ++line) {
    for (int i = 0; i < lines.length(); ++i) {
      const Jump jump = jump_at(lines, line, i, reach);
      if (jump.terms == 0) continue;
      const std::size_t place = lines.at(line, i);
      const float noise = std::max(lines.noise(line, i - reach), lines.noise(line, i + reach));
      jumps.height[place] = jump.height;
      jumps.rise[place] = lines.place(line, i + reach) - lines.place(line, i - reach);
      jumps.sigma[place] = noise * std::sqrt(jump.terms);
    }
  }
  return jumps;
}

}  // namespace

bool Jumps::is_one(std::size_t place, float noise, float shared_sigma) const {
  constexpr float kSigmas = 3, kShared = 2;
  const float allowed = std::hypot(kSigmas * noise * sigma[place], kShared * shared_sigma);
  return std::abs(height[place]) > allowed;
}

std::vector<Jumps> jumps_along(const PlaceGrid& grid, Axis axis,
                               std::initializer_list<int> reaches) {
  const Lines lines(grid, axis);
  std::vector<Jumps> found;
  for (const int reach : reaches) found.push_back(jumps_over(lines, reach, grid.place.size()));
  return found;
}

/// The smaller ones tell, because bends and cliffs are among the larger ones.
float seen_noise(const Jumps& jumps) {
  // Three of ten normal deviates are nearer to 0 than this many sigmas.
  constexpr double kQuantile = 0.3;
  constexpr float kSigmas = 0.3853f;
  std::vector<float> ratios;
  for (std::size_t place = 0; place < jumps.height.size(); ++place) {
    if (jumps.sigma[place] > 0)
      ratios.push_back(std::abs(jumps.height[place]) / jumps.sigma[place]);
  }
  if (ratios.empty()) return 1;
  const auto place = static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(ratios.size()));
  std::ranges::nth_element(ratios, ratios.begin() + place);
  return std::min(ratios[static_cast<std::size_t>(place)] / kSigmas, 1.0f);
}

}  // namespace fathom::depth
