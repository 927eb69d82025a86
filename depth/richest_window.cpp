// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "depth/surfaces.hpp"

namespace fathom {
namespace {

/// What a rectangle of cells holds. Numbers of surfaces are summed with their squares: all are the
/// same where the mean of squares is the square of the mean.
struct Sum {
  std::int64_t cells = 0, numbers = 0, squares = 0;
  double texture = 0, position = 0, position_squares = 0;

  Sum& operator+=(const Sum& other) {
    cells += other.cells;
    numbers += other.numbers;
    squares += other.squares;
    texture += other.texture;
    position += other.position;
    position_squares += other.position_squares;
    return *this;
  }
  Sum& operator-=(const Sum& other) {
    cells -= other.cells;
    numbers -= other.numbers;
    squares -= other.squares;
    texture -= other.texture;
    position -= other.position;
    position_squares -= other.position_squares;
    return *this;
  }

  bool is_of_one_surface() const { return cells > 0 && cells * squares == numbers * numbers; }
  double variance() const {
    const auto count = static_cast<double>(cells);
    return std::max(position_squares / count - std::pow(position / count, 2), 0.0);
  }
};

Sum sum_of(const Surfaces& surfaces, std::size_t cell) {
  const std::int64_t owner = surfaces.owner[cell];
  if (owner == Surfaces::kNone) return {};
  // About the surface's own mean, so that nothing is lost where positions are large.
  const double off =
      surfaces.position[cell] - surfaces.found[static_cast<std::size_t>(owner)].position;
  return {.cells = 1,
          .numbers = owner,
          .squares = owner * owner,
          .texture = surfaces.texture[cell],
          .position = off,
          .position_squares = off * off};
}

/// Sums over any rectangle in one look (Crow 1984).
class SummedArea {
 public:
  explicit SummedArea(const Surfaces& surfaces)
      : across_(static_cast<std::size_t>(surfaces.columns) + 1),
        sums_(across_ * (static_cast<std::size_t>(surfaces.rows) + 1)) {
    for (int row = 0; row < surfaces.rows; ++row) {
      Sum line;
      for (int column = 0; column < surfaces.columns; ++column) {
        line += sum_of(surfaces, static_cast<std::size_t>(row) * surfaces.columns + column);
        Sum sum = line;
        sum += at(column + 1, row);
        sums_[(static_cast<std::size_t>(row) + 1) * across_ + column + 1] = sum;
      }
    }
  }

  Sum of(int column, int row, int side) const {
    Sum sum = at(column + side, row + side);
    sum -= at(column, row + side);
    sum -= at(column + side, row);
    sum += at(column, row);
    return sum;
  }

 private:
  const Sum& at(int column, int row) const {
    return sums_[static_cast<std::size_t>(row) * across_ + column];
  }

  std::size_t across_;
  std::vector<Sum> sums_;
};

/// Texture counts; depths that differ make it worth less.
double merit(const Sum& sum, double usual_sigma) {
  constexpr double kSigmas = 3;
  const double allowed = kSigmas * usual_sigma;
  return sum.texture / (1 + sum.variance() / (allowed * allowed));
}

}  // namespace

std::optional<AimedWindow> richest_window(const Surfaces& surfaces, int n,
                                          std::optional<int> surface) {
  constexpr double kKnown = 0.9;
  const int side = (n + surfaces.side_px - 1) / surfaces.side_px;
  const SummedArea sums(surfaces);
  std::optional<AimedWindow> best;
  double most = -1;
  for (int row = 0; row + side <= surfaces.rows; ++row) {
    for (int column = 0; column + side <= surfaces.columns; ++column) {
      const Window window{column * surfaces.side_px, row * surfaces.side_px, n};
      if (!fits(window, surfaces.width_px, surfaces.height_px)) continue;
      const Sum sum = sums.of(column, row, side);
      if (static_cast<double>(sum.cells) < kKnown * side * side || !sum.is_of_one_surface())
        continue;
      const auto number = static_cast<int>(sum.numbers / sum.cells);
      if (surface && number != *surface) continue;
      const double worth = merit(sum, surfaces.usual_sigma);
      if (worth <= most) continue;
      most = worth;
      best = AimedWindow{window, number};
    }
  }
  return best;
}

}  // namespace fathom
