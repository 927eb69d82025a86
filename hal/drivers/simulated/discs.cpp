// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/discs.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::simulated {
namespace {

constexpr int kColumns = kWidthPx + 1;
constexpr double kPointPx = 0.5;

/// So many chords a row that even a small disc is round.
int chords_per_row(double radius_px) {
  constexpr double kRound = 8;
  return std::max(1, static_cast<int>(std::ceil(kRound / radius_px)));
}

/// The row that a place lies in, for places above the first one too.
int row_of(double place) { return static_cast<int>(std::floor(place + 0.5)); }

}  // namespace

Discs::Discs() : changes_(std::size_t{kHeightPx} * kColumns) {}

/// From here on the row has so much more. A pixel that the place divides gets its part of it.
void Discs::add_end(int row, double place_px, Spread per_px) {
  const double place = std::clamp(place_px + 0.5, 0.0, double{kWidthPx});
  const int col = std::min(static_cast<int>(place), kWidthPx - 1);
  const float later = static_cast<float>(place - col);
  Spread* const cell = changes_.data() + static_cast<std::size_t>(row) * kColumns + col;
  cell[0].light += (1 - later) * per_px.light;
  cell[0].weight += (1 - later) * per_px.weight;
  cell[1].light += later * per_px.light;
  cell[1].weight += later * per_px.weight;
}

void Discs::add_chord(int row, double x, double half_px, Spread per_px) {
  if (row < 0 || row >= kHeightPx || x + half_px <= -0.5 || x - half_px >= kWidthPx - 0.5) return;
  add_end(row, x - half_px, per_px);
  add_end(row, x + half_px, {-per_px.light, -per_px.weight});
}

void Discs::add(int x, int y, double radius_px, double reflectance, double part) {
  if (radius_px < kPointPx) {
    const float weight = static_cast<float>(part);
    return add_chord(y, x, 0.5, {static_cast<float>(reflectance) * weight, weight});
  }
  const int per_row = chords_per_row(radius_px);
  halves_.clear();
  double length = 0;  // of all chords
  for (int k = 0; (k + 0.5) / per_row < radius_px; ++k) {
    const double up = (k + 0.5) / per_row;
    halves_.push_back(std::sqrt(radius_px * radius_px - up * up));
    length += 4 * halves_.back();
  }
  const float weight = static_cast<float>(part / length);
  const Spread per_px{static_cast<float>(reflectance) * weight, weight};
  for (std::size_t k = 0; k < halves_.size(); ++k) {
    const double up = (static_cast<double>(k) + 0.5) / per_row;
    add_chord(row_of(y - up), x, halves_[k], per_px);
    add_chord(row_of(y + up), x, halves_[k], per_px);
  }
}

std::vector<Spread> Discs::sum() {
  std::vector<Spread> sums(std::size_t{kHeightPx} * kWidthPx);
  for (int row = 0; row < kHeightPx; ++row) {
    Spread sum;
    for (int col = 0; col < kWidthPx; ++col) {
      const Spread& change = changes_[static_cast<std::size_t>(row) * kColumns + col];
      sum.light += change.light;
      sum.weight += change.weight;
      sums[static_cast<std::size_t>(row) * kWidthPx + col] = sum;
    }
  }
  return sums;
}

}  // namespace fathom::simulated
