// SPDX-License-Identifier: Apache-2.0
#include "depth/beyond.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fathom::depth {
namespace {

/// The energy of detail in the largest windows: [node][frame]. NaN where a frame does not show one.
class LargestWindows {
 public:
  LargestWindows(const Scoring& scoring, std::span<const std::size_t> frames)
      : level_(scoring.levels().back()),
        frames_(frames.size()),
        energies_(level_.nodes() * frames_) {
    std::vector<float> powers(level_.nodes() * kRings);
    for (std::size_t z = 0; z < frames_; ++z) {
      scoring.rings(scoring.levels().size() - 1).take(frames[z], 0, powers);
      for (std::size_t node = 0; node < level_.nodes(); ++node) {
        float& energy = energies_[node * frames_ + z];
        for (int k = 0; k < kRings; ++k)
          energy += static_cast<float>(ring_counts()[k]) * powers[node * kRings + k];
      }
    }
  }

  /// Whether all frames show it.
  static bool is_whole(std::span<const float> window) {
    return std::ranges::none_of(window, [](float energy) { return std::isnan(energy); });
  }

  /// The mean of those that all frames show, [frame]; nothing where there is none.
  std::vector<float> whole() const {
    std::vector<float> sum;
    float count = 0;
    for (std::size_t node = 0; node < level_.nodes(); ++node) {
      const std::span<const float> window = of(node);
      if (!is_whole(window)) continue;
      sum.resize(frames_);
      for (std::size_t z = 0; z < frames_; ++z) sum[z] += window[z];
      ++count;
    }
    for (float& energy : sum) energy /= count;
    return sum;
  }

  /// Of the window whose middle is nearest, [frame].
  std::span<const float> at(double x_px, double y_px) const {
    const auto row = static_cast<std::size_t>(nearest(y_px, level_.rows));
    return of(row * level_.columns + nearest(x_px, level_.columns));
  }

 private:
  std::span<const float> of(std::size_t node) const {
    return std::span(energies_).subspan(node * frames_, frames_);
  }

  int nearest(double place_px, int count) const {
    const double node = (place_px - level_.first_px()) / level_.pitch_px();
    return std::clamp(static_cast<int>(std::lround(node)), 0, count - 1);
  }

  Level level_;
  std::size_t frames_;
  std::vector<float> energies_;
};

float rise_of(std::span<const float> detail) {
  const auto [least, greatest] = std::ranges::minmax(detail);
  return greatest - least;
}

}  // namespace

void doubt_beyond(const Scoring& scoring, std::span<const std::size_t> frames, const Ends& ends,
                  Nodes& nodes) {
  const LargestWindows windows(scoring, frames);
  const std::vector<float> whole = windows.whole();
  if (whole.empty() || ends.hold(whole)) return;
  const float usual = rise_of(whole);
  const Level& level = nodes.level;
  for (std::size_t node = 0; node < nodes.peaks.size(); ++node) {
    Peak& peak = nodes.peaks[node];
    if (peak.kind != DepthClass::known) continue;
    const double x =
        level.first_px() + level.pitch_px() * static_cast<double>(node % level.columns);
    const double y =
        level.first_px() + level.pitch_px() * static_cast<double>(node / level.columns);
    const std::span around = windows.at(x, y);
    if (!LargestWindows::is_whole(around)) continue;
    if (!ends.hold(around) || rise_of(around) < usual) peak.kind = DepthClass::at_end;
  }
}

}  // namespace fathom::depth
