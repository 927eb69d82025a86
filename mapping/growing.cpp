// SPDX-License-Identifier: Apache-2.0
#include "mapping/growing.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "engine/quantile.hpp"

namespace fathom::mapping {
namespace {

/// Cells from `first` up to `end` along one axis.
struct Range {
  int first = 0, end = 0;
};

Range part_of(int i, int parts, int cells) {
  const int first = i * cells / parts;
  return {first, std::max((i + 1) * cells / parts, first + 1)};
}

float energy_of(const CurveGrid& curves, std::size_t frame, const Range& across,
                const Range& down) {
  float sum = 0;
  for (int y = down.first; y < down.end; ++y) {
    for (int x = across.first; x < across.end; ++x)
      sum += curves.frames[frame][static_cast<std::size_t>(y) * curves.columns + x];
  }
  return sum;
}

int sharpest_of(std::vector<float> energies) {
  constexpr float kStandsOut = 1.3f;
  constexpr std::size_t kFewest = 3;
  if (energies.size() < kFewest) return kNoFrame;
  const auto best = std::ranges::max_element(energies);
  const auto frame = static_cast<int>(best - energies.begin());
  const float most = *best;
  return most > kStandsOut * median(std::move(energies)) ? frame : kNoFrame;
}

}  // namespace

std::vector<int> sharpest_frames(const CurveGrid& curves, int columns, int rows) {
  std::vector<int> sharpest;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      std::vector<float> energies;
      for (std::size_t frame = 0; frame < curves.frames.size(); ++frame) {
        energies.push_back(energy_of(curves, frame, part_of(column, columns, curves.columns),
                                     part_of(row, rows, curves.rows)));
      }
      sharpest.push_back(sharpest_of(std::move(energies)));
    }
  }
  return sharpest;
}

}  // namespace fathom::mapping
