// SPDX-License-Identifier: Apache-2.0
#include "depth/cascade.hpp"

#include <algorithm>
#include <cmath>

#include "depth/parallel.hpp"

namespace fathom::depth {
namespace {

/// Chi-squared that a window must explain for the next larger ones to count half.
constexpr float kEnough = 50;
constexpr float kNothing = 1e-20f;
/// What noise alone seems to explain at its best focus.
constexpr float kChance = 15;
constexpr float kBinomial[] = {0.25f, 0.5f, 0.25f};

/// sum += weight * other
void add(std::span<float> sum, const float* other, float weight) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * other[i];
}

/// How much a profile tells.
float told_by(std::span<const float> profile) {
  return std::max(std::ranges::max(profile) - kChance, 0.0f);
}

/// Between which two nodes of a coarser level a place lies, and how far from the first.
struct Between {
  int first = 0;
  float part = 0;
};

Between between(double place_px, const Level& coarser, int count) {
  const double place = std::clamp((place_px - coarser.first_px()) / coarser.pitch_px(), 0.0,
                                  static_cast<double>(count - 1));
  const int first = std::min(static_cast<int>(place), count - 2);
  return {first, static_cast<float>(place - first)};
}

double place_px(const Level& level, int i) { return level.first_px() + i * level.pitch_px(); }

}  // namespace

void Cascade::Origin::add(const Origin& other) {
  const float all = most + other.most + kNothing, part = other.most / all;
  side_px += part * (other.side_px - side_px);
  dx_px += part * (other.dx_px - dx_px);
  dy_px += part * (other.dy_px - dy_px);
  most = all;
}

Cascade::Cascade(const Scoring& scoring, std::span<const std::size_t> frames,
                 std::span<const double> positions, const StackBlur& blur, const FocusGrid& grid,
                 const Ends& ends)
    : scoring_(scoring),
      frames_(frames),
      foci_(grid.size),
      numbers_(foci_ + frames.size()),
      grid_(grid),
      ends_(ends) {
  for (const Level& level : scoring.levels()) filters_.emplace_back(level, blur, positions, grid);
}

Cascade::Rows Cascade::own(std::size_t level, int first, int end) const {
  const int columns = at(level).columns;
  const std::size_t frames = frames_.size();
  Rows rows(first, end, columns, numbers_);
  constexpr std::size_t kAtOnce = 64;
  std::vector<float> of_frame(kAtOnce * kRings), powers(kAtOnce * kRings * frames);
  const std::size_t begin = static_cast<std::size_t>(first) * columns;
  const std::size_t nodes = static_cast<std::size_t>(end - first) * columns;
  for (std::size_t done = 0; done < nodes; done += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, nodes - done);
    for (std::size_t z = 0; z < frames; ++z) {
      scoring_.rings(level).take(frames_[z], (begin + done) * kRings,
                                 std::span(of_frame).first(count * kRings));
      for (std::size_t i = 0; i < count * kRings; ++i) powers[i * frames + z] = of_frame[i];
    }
    for (std::size_t i = 0; i < count; ++i) {
      filters_[level].explain(std::span(powers).subspan(i * kRings * frames, kRings * frames),
                              told(rows, done + i));
      rows.origins[done + i].most = told_by(profile(rows, done + i));
    }
  }
  return rows;
}

Cascade::Rows Cascade::smoothed(std::size_t level, int first, int end) const {
  const int columns = at(level).columns, last_row = at(level).rows - 1;
  const Rows own_rows = own(level, std::max(first - 1, 0), std::min(end + 1, last_row + 1));
  const std::size_t line = columns * numbers_;
  Rows rows(first, end, columns, numbers_);
  std::vector<float> column(line);
  for (int row = first; row < end; ++row) {
    std::ranges::fill(column, 0.0f);
    for (int i = -1; i <= 1; ++i) {
      const int from = std::clamp(row + i, 0, last_row) - own_rows.first;
      add(column, own_rows.told.data() + from * line, kBinomial[i + 1]);
    }
    for (int x = 0; x < columns; ++x) {
      const std::span out =
          std::span(rows.told).subspan((row - first) * line + x * numbers_, numbers_);
      for (int i = -1; i <= 1; ++i) {
        const int from = std::clamp(x + i, 0, columns - 1);
        add(out, column.data() + from * numbers_, kBinomial[i + 1]);
      }
    }
  }
  smooth_origins(level, own_rows, rows);
  return rows;
}

void Cascade::smooth_origins(std::size_t level, const Rows& own_rows, Rows& rows) const {
  const Level& its = at(level);
  for (int row = rows.first; row < rows.end; ++row) {
    for (int column = 0; column < its.columns; ++column) {
      Origin& out = rows.origins[static_cast<std::size_t>(row - rows.first) * its.columns + column];
      float all = kNothing;
      for (int i = 0; i < 9; ++i) {
        const int x = std::clamp(column + i % 3 - 1, 0, its.columns - 1);
        const int y = std::clamp(row + i / 3 - 1, 0, its.rows - 1);
        const float weight = kBinomial[i % 3] * kBinomial[i / 3];
        const auto& from =
            own_rows.origins[static_cast<std::size_t>(y - own_rows.first) * its.columns + x];
        all += weight * from.most;
        out.dx_px += weight * from.most * static_cast<float>(x - column);
        out.dy_px += weight * from.most * static_cast<float>(y - row);
      }
      const float to_px = static_cast<float>(its.pitch_px()) / all;
      out = {.most = told_by(profile(rows, &out - rows.origins.data())),
             .side_px = static_cast<float>(its.side_px()),
             .dx_px = out.dx_px * to_px,
             .dy_px = out.dy_px * to_px};
    }
  }
}

Cascade::Rows Cascade::combined(std::size_t level, int first, int end) const {
  Rows rows = smoothed(level, first, end);
  if (level + 1 == scoring_.levels().size()) return rows;
  const Level &fine = at(level), &coarse = at(level + 1);
  const int low = between(place_px(fine, first), coarse, coarse.rows).first;
  const int high = between(place_px(fine, end - 1), coarse, coarse.rows).first + 2;
  add_coarser(level, combined(level + 1, low, high), rows);
  return rows;
}

void Cascade::add_coarser(std::size_t level, const Rows& coarser, Rows& rows) const {
  const Level &fine = at(level), &coarse = at(level + 1);
  for (int row = rows.first; row < rows.end; ++row) {
    const Between v = between(place_px(fine, row), coarse, coarse.rows);
    for (int column = 0; column < fine.columns; ++column) {
      const Between u = between(place_px(fine, column), coarse, coarse.columns);
      const std::size_t node = static_cast<std::size_t>(row - rows.first) * fine.columns + column;
      Origin& origin = rows.origins[node];
      const float weight = kEnough / (kEnough + origin.most);
      for (int corner = 0; corner < 4; ++corner) {
        const int x = u.first + corner % 2, y = v.first + corner / 2;
        const float share =
            weight * (corner % 2 ? u.part : 1 - u.part) * (corner / 2 ? v.part : 1 - v.part);
        const std::size_t from = static_cast<std::size_t>(y - coarser.first) * coarse.columns + x;
        add(told(rows, node), told(coarser, from).data(), share);
        Origin other = coarser.origins[from];
        other.dx_px += static_cast<float>(place_px(coarse, x) - place_px(fine, column));
        other.dy_px += static_cast<float>(place_px(coarse, y) - place_px(fine, row));
        other.most *= share;
        origin.add(other);
      }
    }
  }
}

int Cascade::rows_at_once() const {
  // Profiles of a thread, and about as much again for those that they are made of.
  constexpr std::size_t kBytes = 8 << 20;
  const std::size_t line = at(0).columns * numbers_ * sizeof(float);
  return static_cast<int>(std::clamp<std::size_t>(kBytes / line, 4, 64));
}

std::vector<Peak> Cascade::peaks(int first, int end) const {
  const Rows rows = combined(0, first, end);
  std::vector<Peak> peaks(rows.origins.size());
  for (std::size_t i = 0; i < peaks.size(); ++i) {
    Peak& peak = peaks[i];
    peak = peak_of(profile(rows, i));
    peak.side_px = rows.origins[i].side_px;
    peak.dx_px = rows.origins[i].dx_px;
    peak.dy_px = rows.origins[i].dy_px;
    const bool is_within = peak.kind != DepthClass::known ||
                           ends_.lie_below(told(rows, i).subspan(foci_), grid_.at(peak.place));
    if (!is_within) peak.kind = DepthClass::at_end;
  }
  return peaks;
}

Nodes Cascade::nodes(int threads) const {
  Nodes nodes{at(0), std::vector<Peak>(at(0).nodes())};
  share_out(at(0).rows, rows_at_once(), threads, [&](std::size_t first, std::size_t end) {
    std::ranges::copy(peaks(static_cast<int>(first), static_cast<int>(end)),
                      nodes.peaks.begin() + static_cast<std::ptrdiff_t>(first * at(0).columns));
  });
  return nodes;
}

}  // namespace fathom::depth
