// SPDX-License-Identifier: Apache-2.0
#include "depth/cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom::depth {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

int side_of(const DepthMaps& maps) {
  constexpr float kInReach = 6;  // Most of a smeared cliff is four cells wide.
  constexpr int kSmallest = 2, kLargest = 16;
  const auto side = static_cast<int>(std::lround(maps.reach_px / kInReach));
  return std::clamp(side, kSmallest, kLargest);
}

/// What one cell comes to.
class CellSum {
 public:
  CellSum(const DepthMaps& maps, const Frame* sharp) : maps_(maps), sharp_(sharp) {}

  void add(int x, int y) {
    const std::size_t pixel = static_cast<std::size_t>(y) * maps_.width_px + x;
    ++all_;
    if (sharp_) texture_ += difference(x, y, x + 1, y) + difference(x, y, x, y + 1);
    if (maps_.classes[pixel] != DepthClass::known) return;
    const float shared = maps_.shared_sigma;
    position_ += maps_.position[pixel];
    variance_ += std::max(maps_.sigma[pixel] * maps_.sigma[pixel] - shared * shared, 0.0f);
    ++known_;
  }

  void write(Cells& cells, std::size_t cell) const {
    const bool is_known = 2 * known_ > all_;
    cells.position[cell] = is_known ? static_cast<float>(position_ / known_) : kUnknown;
    cells.noise[cell] = is_known ? static_cast<float>(std::sqrt(variance_ / known_)) : kUnknown;
    cells.texture[cell] = static_cast<float>(texture_);
    cells.known_px[cell] = known_;
  }

 private:
  double difference(int x, int y, int to_x, int to_y) const {
    if (to_x >= maps_.width_px || to_y >= maps_.height_px) return 0;
    const double off = static_cast<double>(sharp_->at(to_x, to_y)) - sharp_->at(x, y);
    return off * off;
  }

  const DepthMaps& maps_;
  const Frame* sharp_;
  double position_ = 0, variance_ = 0, texture_ = 0;
  int known_ = 0, all_ = 0;
};

/// The cells along one axis, averaged along the other one, where noise is none of a jump's affair.
class Lines {
 public:
  /// along: whether jumps are looked for from column to column.
  Lines(const Cells& cells, bool along_rows)
      : length_(along_rows ? cells.columns : cells.rows),
        lines_(along_rows ? cells.rows : cells.columns),
        step_(along_rows ? 1 : static_cast<std::size_t>(cells.columns)),
        next_line_(along_rows ? static_cast<std::size_t>(cells.columns) : 1),
        position_(cells.size(), kUnknown),
        noise_(cells.size(), kUnknown) {
    for (int line = 0; line < lines_; ++line) {
      for (int i = 0; i < length_; ++i) average(cells, line, i);
    }
  }

  int length() const { return length_; }
  int lines() const { return lines_; }
  std::size_t at(int line, int i) const { return line * next_line_ + i * step_; }
  /// NaN where nothing is known, and beyond the ends.
  float position(int line, int i) const {
    return i < 0 || i >= length_ ? kUnknown : position_[at(line, i)];
  }
  float noise(int line, int i) const { return noise_[at(line, i)]; }

  static constexpr int kBeside = 3;  ///< Cells to each side that are averaged.

 private:
  void average(const Cells& cells, int line, int i) {
    float position = 0, variance = 0;
    int known = 0, all = 0;
    for (int k = std::max(line - kBeside, 0); k <= std::min(line + kBeside, lines_ - 1); ++k) {
      const std::size_t cell = at(k, i);
      ++all;
      if (!cells.is_known(cell)) continue;
      position += cells.position[cell];
      variance += cells.noise[cell] * cells.noise[cell];
      ++known;
    }
    if (2 * known <= all) return;
    position_[at(line, i)] = position / static_cast<float>(known);
    noise_[at(line, i)] = std::sqrt(variance / static_cast<float>(known));
  }

  int length_, lines_;
  std::size_t step_, next_line_;
  std::vector<float> position_, noise_;
};

/// By how much the surface jumps at a place, beyond the slopes on both sides of it; 0 where that
/// cannot be told. A surface that bends the same way on both sides jumps nowhere.
struct Jump {
  float height = 0;
  float terms = 0;  ///< Sum of the squared weights of the positions that it is made of.
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
  const float low = lines.position(line, i - reach), high = lines.position(line, i + reach);
  const float before = low - lines.position(line, i - far);
  const float after = lines.position(line, i + far) - high;
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

/// The jumps along one axis, and their sigmas by the map's word.
struct Jumps {
  std::vector<float> height, sigma;  ///< Of each cell; 0 where there can be none.
};

Jumps jumps_along(const Lines& lines, int reach, std::size_t cells) {
  Jumps jumps{std::vector<float>(cells), std::vector<float>(cells)};
  for (int line = 0; line < lines.lines(); ++line) {
    for (int i = 0; i < lines.length(); ++i) {
      const Jump jump = jump_at(lines, line, i, reach);
      if (jump.terms == 0) continue;
      const float noise = std::max(lines.noise(line, i - reach), lines.noise(line, i + reach));
      jumps.height[lines.at(line, i)] = jump.height;
      jumps.sigma[lines.at(line, i)] = noise * std::sqrt(jump.terms);
    }
  }
  return jumps;
}

/// How much of the noise that the map admits is seen where it does not jump: a part of 1 at most.
/// The smaller ones tell, because bends and cliffs are among the larger ones.
float seen_noise(const Jumps& jumps) {
  // Three of ten normal deviates are nearer to 0 than this many sigmas.
  constexpr double kQuantile = 0.3;
  constexpr float kSigmas = 0.3853f;
  std::vector<float> ratios;
  for (std::size_t cell = 0; cell < jumps.height.size(); ++cell) {
    if (jumps.sigma[cell] > 0) ratios.push_back(std::abs(jumps.height[cell]) / jumps.sigma[cell]);
  }
  if (ratios.empty()) return 1;
  const auto place = static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(ratios.size()));
  std::ranges::nth_element(ratios, ratios.begin() + place);
  return std::min(ratios[static_cast<std::size_t>(place)] / kSigmas, 1.0f);
}

void mark(const Jumps& found, float shared_sigma, std::vector<char>& jumps) {
  constexpr float kSigmas = 3, kShared = 2;
  const float part = seen_noise(found);
  for (std::size_t cell = 0; cell < jumps.size(); ++cell) {
    const float allowed = std::hypot(kSigmas * part * found.sigma[cell], kShared * shared_sigma);
    if (std::abs(found.height[cell]) > allowed) jumps[cell] = 1;
  }
}

}  // namespace

Cells cells_of(const DepthMaps& maps, const Frame* sharp) {
  Cells cells{.side_px = side_of(maps)};
  cells.columns = (maps.width_px + cells.side_px - 1) / cells.side_px;
  cells.rows = (maps.height_px + cells.side_px - 1) / cells.side_px;
  const std::size_t count = static_cast<std::size_t>(cells.columns) * cells.rows;
  cells.position.resize(count);
  cells.noise.resize(count);
  cells.texture.resize(count);
  cells.known_px.resize(count);
  for (int row = 0; row < cells.rows; ++row) {
    const int top = row * cells.side_px, bottom = std::min(top + cells.side_px, maps.height_px);
    for (int column = 0; column < cells.columns; ++column) {
      const int left = column * cells.side_px;
      const int right = std::min(left + cells.side_px, maps.width_px);
      CellSum sum(maps, sharp);
      for (int y = top; y < bottom; ++y) {
        for (int x = left; x < right; ++x) sum.add(x, y);
      }
      sum.write(cells, cells.at(column, row));
    }
  }
  return cells;
}

std::vector<char> jumps_of(const Cells& cells, const DepthMaps& maps) {
  std::vector<char> jumps(cells.size());
  // Cliffs of clear texture are narrow, and those of faint texture wide.
  for (const bool along_rows : {true, false}) {
    const Lines lines(cells, along_rows);
    for (const int reach : {kReachCells, 2 * kReachCells})
      mark(jumps_along(lines, reach, cells.size()), maps.shared_sigma, jumps);
  }
  return jumps;
}

}  // namespace fathom::depth
