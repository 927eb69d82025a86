// SPDX-License-Identifier: Apache-2.0
#include "depth/chance.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "depth/disorder.hpp"
#include "depth/parallel.hpp"

namespace fathom::depth {
namespace {

/// A peak with less is a guess.
constexpr float kLeastConfidence = 0.5f;

/// Rows at a time, and how many nodes are enough.
constexpr int kStrip = 8;
constexpr double kEnoughNodes = 15'000;
/// All of a picture's noise may change from frame to frame: one disorder may tell less than order
/// everywhere.
constexpr unsigned kDisorders = 3;

/// Part of a node that is its own: windows are smoothed with their neighbours, half a side away.
float own_part(const Peak& peak, const Level& level) {
  constexpr float kShared = 1.5f;
  const float nodes = kShared * peak.side_px / static_cast<float>(level.pitch_px());
  return 1 / std::max(nodes * nodes, 1.0f);
}

/// First rows of strips all over the picture.
std::vector<int> strips_of(const Level& level) {
  const int all = (level.rows + kStrip - 1) / kStrip;
  const double wanted = kEnoughNodes / (static_cast<double>(level.columns) * kStrip);
  const int every = std::max(static_cast<int>(all / std::max(wanted, 1.0)), 1);
  std::vector<int> strips;
  for (int strip = every / 2; strip < all; strip += every) strips.push_back(strip * kStrip);
  return strips;
}

/// The stack in disorder, a few times over.
class Disordered {
 public:
  explicit Disordered(const CascadeOf& of) {
    frames_.reserve(kDisorders);
    for (unsigned seed = 0; seed < kDisorders; ++seed) {
      frames_.emplace_back();
      // The law was fitted with the first of all disorders beside it.
      for (const std::size_t i : disorder(of.frames.size(), 2 + seed))
        frames_.back().push_back(of.frames[i]);
      cascades_.emplace_back(of.scoring, frames_.back(), of.positions, of.blur, of.grid, of.ends);
    }
  }

  /// Of each node of some rows, the one that tells most.
  std::vector<Peak> peaks(int first_row, int end_row) const {
    std::vector<Peak> most = cascades_.front().peaks(first_row, end_row);
    for (std::size_t i = 1; i < cascades_.size(); ++i) {
      const std::vector<Peak> others = cascades_[i].peaks(first_row, end_row);
      std::ranges::transform(most, others, most.begin(),
                             [](const Peak& a, const Peak& b) { return a.told < b.told ? b : a; });
    }
    return most;
  }

 private:
  std::vector<std::vector<std::size_t>> frames_;
  std::vector<Cascade> cascades_;
};

Chance chance_of(const CascadeOf& of, const Nodes& nodes, int threads) {
  const Disordered disordered(of);
  const std::vector<int> strips = strips_of(nodes.level);
  std::vector<std::vector<Peak>> found(strips.size());
  share_out(strips.size(), 1, threads, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i)
      found[i] = disordered.peaks(strips[i], std::min(strips[i] + kStrip, nodes.level.rows));
  });
  Chance chance(kDisorders);
  for (std::size_t strip = 0; strip < strips.size(); ++strip) {
    const Peak* const ordered = &nodes.at(0, strips[strip]);
    for (std::size_t i = 0; i < found[strip].size(); ++i) {
      const Peak& other = found[strip][i];
      chance.add(ordered[i].told, own_part(ordered[i], nodes.level), other.told,
                 own_part(other, nodes.level));
    }
  }
  chance.settle();
  return chance;
}

/// What is left of a peak where such a part of what tells as much is noise.
void doubt(Peak& peak, float noise) {
  const bool was_known = peak.kind == DepthClass::known;
  if (!was_known && peak.kind != DepthClass::at_end) return;
  peak.confidence *= 1 - noise;
  if ((was_known ? peak.confidence : 1 - noise) < kLeastConfidence)
    peak.kind = DepthClass::no_texture;
}

}  // namespace

std::size_t Chance::bin_of(float told) {
  constexpr float kLeast = 4, kFactor = 1.25f;
  if (!(told > kLeast)) return 0;
  static const float per_log = 1 / std::log(kFactor);
  return std::min(static_cast<std::size_t>(1 + std::log(told / kLeast) * per_log), kBins - 1);
}

void Chance::add(float told, float weight, float in_disorder, float weight_in_disorder) {
  if (told > in_disorder) {
    ordered_[bin_of(told)] += weight;
  } else {
    disordered_[bin_of(in_disorder)] += share_ * weight_in_disorder;
  }
}

void Chance::settle() {
  // Where places are few, what tells somewhat less is asked too. Noise that tells more is rarer.
  constexpr float kFew = 3, kRarer = 0.85f, kAtFirst = 0.25f;
  const auto around = [](const Counts& counts, std::size_t bin) {
    float sum = 0;
    for (std::size_t i = std::max<std::size_t>(bin, 1) - 1; i < std::min(bin + 2, kBins); ++i)
      sum += counts[i];
    return sum;
  };
  float usual = kAtFirst;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    // As many as there may be, within the deviation of their count.
    const float counted = around(disordered_, bin);
    const float noise = counted + std::sqrt(share_ * counted);
    part_[bin] = std::min((noise + kFew * usual) / (around(ordered_, bin) + kFew), 1.0f);
    usual = kRarer * part_[bin];
  }
  // What tells less is no less often noise.
  for (std::size_t bin = kBins - 1; bin-- > 0;) part_[bin] = std::max(part_[bin], part_[bin + 1]);
}

float Chance::of(float told) const { return part_[bin_of(told)]; }

void doubt_noise(const CascadeOf& of, Nodes& nodes, int threads) {
  constexpr std::size_t kFewest = 5;
  if (of.frames.size() < kFewest) return;
  const Chance chance = chance_of(of, nodes, threads);
  for (Peak& peak : nodes.peaks) doubt(peak, chance.of(peak.told));
}

}  // namespace fathom::depth
