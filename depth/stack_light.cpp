// SPDX-License-Identifier: Apache-2.0
#include "depth/stack_light.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "depth/placed.hpp"
#include "engine/error.hpp"
#include "engine/quantile.hpp"

namespace fathom {
namespace {

constexpr int kMostCells = 128, kSmallestCell_px = 4;
/// Cells along a side of a part; parts are what is robust.
constexpr int kPart = 8;
/// What nobody sees: half a level of 8 bits in the brightest place.
constexpr double kUnseen = 0.002;
/// A lamp that is off makes no picture brighter than so.
constexpr double kMostGain = 8;

struct RowFacts {
  std::uint32_t sum = 0, brightest = 0;
};

/// Of `count` samples from `at` on.
template <class Sample>
RowFacts facts_of(const std::byte* at, int count) {
  RowFacts facts;
  for (int i = 0; i < count; ++i, at += sizeof(Sample)) {
    Sample value{};
    std::memcpy(&value, at, sizeof value);
    facts.sum += value;
    facts.brightest = std::max<std::uint32_t>(facts.brightest, value);
  }
  return facts;
}

RowFacts facts_of(const Frame& grey, int x, int y, int count) {
  const std::byte* const at =
      grey.row(y) + static_cast<std::size_t>(x) * bytes_per_pixel(grey.depth());
  return grey.depth() == Depth::bits8 ? facts_of<std::uint8_t>(at, count)
                                      : facts_of<std::uint16_t>(at, count);
}

/// Sums of a place in both pictures.
struct Pair {
  double first = 0, other = 0;
};

double ratio_of(const std::vector<Pair>& parts, const std::vector<double>& weights) {
  double first = 0, other = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    first += weights[i] * parts[i].first;
    other += weights[i] * parts[i].other;
  }
  return other > 0 ? first / other : 1;
}

/// The ratio that most of the parts have.
double robust_ratio(const std::vector<Pair>& parts) {
  constexpr int kSteps = 8;
  constexpr double kWithin = 2;  // times what is usual: 1.35 sigma
  std::vector<double> weights(parts.size(), 1.0), offs(parts.size());
  double ratio = ratio_of(parts, weights);
  for (int step = 0; step < kSteps; ++step) {
    for (std::size_t i = 0; i < parts.size(); ++i)
      offs[i] = std::abs(parts[i].first - ratio * parts[i].other);
    const double limit = kWithin * median(offs);
    for (std::size_t i = 0; i < parts.size(); ++i)
      weights[i] = offs[i] > limit ? limit / offs[i] : 1;
    ratio = ratio_of(parts, weights);
  }
  return ratio;
}

/// Sums of cells, in square parts of the picture.
class Comparison {
 public:
  Comparison(int columns, int rows) : across_((columns + kPart - 1) / kPart) {
    parts_.resize(std::size_t{1} * across_ * ((rows + kPart - 1) / kPart));
  }
  void add(int column, int row, const Pair& cell) {
    Pair& part = parts_[std::size_t{1} * (row / kPart) * across_ + column / kPart];
    part.first += cell.first;
    part.other += cell.other;
    ++count_;
  }
  std::size_t count() const { return count_; }
  double ratio() const {
    std::vector<Pair> parts = parts_;
    std::erase_if(parts, [](const Pair& part) { return !(part.other > 0); });
    return parts.empty() ? 1 : robust_ratio(parts);
  }

 private:
  int across_;
  std::vector<Pair> parts_;
  std::size_t count_ = 0;
};

/// The four cells round a point, given in cells; it lies within the outermost ones' middles.
class Between {
 public:
  Between(double x, double y, int columns, int rows)
      : left_(static_cast<int>(x)), top_(static_cast<int>(y)), u_(x - left_), v_(y - top_) {
    const int right = std::min(left_ + 1, columns - 1), bottom = std::min(top_ + 1, rows - 1);
    const auto at = [&](int column, int row) { return std::size_t{1} * row * columns + column; };
    at_ = {at(left_, top_), at(right, top_), at(left_, bottom), at(right, bottom)};
  }
  double value(const std::vector<float>& cells) const {
    return (1 - v_) * ((1 - u_) * cells[at_[0]] + u_ * cells[at_[1]]) +
           v_ * ((1 - u_) * cells[at_[2]] + u_ * cells[at_[3]]);
  }
  bool any(const std::vector<bool>& cells) const {
    return std::ranges::any_of(at_, [&](std::size_t i) { return cells[i]; });
  }

 private:
  int left_, top_;
  double u_, v_;
  std::array<std::size_t, 4> at_;
};

}  // namespace

double StackLight::add(const Frame& grey, const Similarity& place) {
  if (side_px_ == 0) {
    width_px_ = grey.width_px();
    height_px_ = grey.height_px();
    const int side = (std::max(width_px_, height_px_) + kMostCells - 1) / kMostCells;
    side_px_ = std::max(side, kSmallestCell_px);
    first_ = cells_of(grey);
    return 1;
  }
  if (grey.width_px() != width_px_ || grey.height_px() != height_px_) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("the light of a picture of {} x {} px is not told by one of {} x {}",
                            grey.width_px(), grey.height_px(), width_px_, height_px_));
  }
  const double gain = std::clamp(gain_of(cells_of(grey), place), 1 / kMostGain, kMostGain);
  return std::abs(gain - 1) < kUnseen ? 1 : gain;
}

StackLight::Cells StackLight::cells_of(const Frame& grey) const {
  constexpr int kRowsOfCell = 8;  // so many say what all would
  Cells cells;
  cells.columns = width_px_ / side_px_;
  cells.rows = height_px_ / side_px_;
  const std::size_t count = std::size_t{1} * cells.columns * cells.rows;
  std::vector<std::uint32_t> brightest(count);
  const int step = std::max(1, side_px_ / kRowsOfCell), rows = (side_px_ + step - 1) / step;
  for (std::size_t i = 0; i < count; ++i) {
    const int column = static_cast<int>(i) % cells.columns;
    const int row = static_cast<int>(i) / cells.columns;
    double sum = 0;
    for (int y = 0; y < side_px_; y += step) {
      const RowFacts facts = facts_of(grey, column * side_px_, row * side_px_ + y, side_px_);
      sum += facts.sum;
      brightest[i] = std::max(brightest[i], facts.brightest);
    }
    cells.means.push_back(static_cast<float>(sum / (rows * side_px_)));
  }
  note_clipped(grey, brightest, cells);
  return cells;
}

void StackLight::note_clipped(const Frame& grey, const std::vector<std::uint32_t>& brightest,
                              Cells& cells) const {
  constexpr double kClipped = 0.97;  // of the ceiling: luma is below it where one colour is clipped
  std::uint32_t ceiling = std::numeric_limits<std::uint8_t>::max();
  if (grey.depth() == Depth::bits16 && !brightest.empty())
    ceiling = *std::ranges::max_element(brightest);  // cameras of 10 to 14 bits end where they end
  for (const std::uint32_t value : brightest)
    cells.is_clipped.push_back(value >= kClipped * ceiling);
}

double StackLight::gain_of(const Cells& cells, const Similarity& place) const {
  Comparison all(cells.columns, cells.rows), unclipped = all;
  const double half = 0.5 * (side_px_ - 1);
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.columns; ++column) {
      const depth::Point at = depth::place_of(place, column * side_px_ + half,
                                              row * side_px_ + half, width_px_, height_px_);
      const double x = (at.x - half) / side_px_, y = (at.y - half) / side_px_;
      if (!(x >= 0 && y >= 0 && x <= cells.columns - 1 && y <= cells.rows - 1)) continue;
      const std::size_t here = std::size_t{1} * row * cells.columns + column;
      const Between four(x, y, cells.columns, cells.rows);
      const Pair pair{first_.means[here], four.value(cells.means)};
      all.add(column, row, pair);
      if (!first_.is_clipped[here] && !four.any(cells.is_clipped)) unclipped.add(column, row, pair);
    }
  }
  // Few dark places between clipped ones would be no fair sample.
  return 4 * unclipped.count() >= all.count() ? unclipped.ratio() : all.ratio();
}

}  // namespace fathom
