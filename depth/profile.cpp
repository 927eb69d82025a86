// SPDX-License-Identifier: Apache-2.0
#include "depth/profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "depth/correlate.hpp"
#include "engine/optics.hpp"

namespace fathom::depth {
namespace {

/// Radii of a ring's coefficients, cycles per pixel.
std::array<std::vector<double>, kRings> radii_of_rings() {
  std::array<std::vector<double>, kRings> radii;
  for (int v = -kSide / 2; v < kSide / 2; ++v) {
    for (int u = -kSide / 2; u < kSide / 2; ++u) {
      const double radius = std::hypot(u, v);
      const int ring = static_cast<int>(std::ceil(radius / (0.5 * kSide) * kRings)) - 1;
      if (ring >= 0 && ring < kRings) radii[ring].push_back(radius / kSide);
    }
  }
  return radii;
}

const std::array<std::vector<double>, kRings>& ring_radii() {
  static const auto radii = radii_of_rings();
  return radii;
}

double squared_transfer(double x, BlurShape shape) {
  // exp(-2 pi^2 sigma^2 f^2) with sigma = diameter/4 is exp(-x^2/8).
  const double otf = shape == BlurShape::disc ? optics::disc_otf(x) : std::exp(-x * x / 8);
  return otf * otf;
}

/// What is left at a blur in steps of a tenth of a pixel; beyond the table nothing.
class TransferTable {
 public:
  explicit TransferTable(BlurShape shape) {
    for (int row = 0; row < kRows; ++row) rows_.push_back(ring_transfer(row * kRowPx, shape));
  }

  float operator()(double diameter_px, int ring) const {
    const double place = std::min(diameter_px / kRowPx, kRows - 1.001);
    const auto row = static_cast<std::size_t>(place);
    const auto part = static_cast<float>(place - static_cast<double>(row));
    return rows_[row][ring] + part * (rows_[row + 1][ring] - rows_[row][ring]);
  }

  static const TransferTable& of(BlurShape shape) {
    static const TransferTable disc(BlurShape::disc), gaussian(BlurShape::gaussian);
    return shape == BlurShape::disc ? disc : gaussian;
  }

 private:
  static constexpr double kRowPx = 0.1;
  static constexpr int kRows = 640;
  std::vector<std::array<float, kRings>> rows_;
};

/// Of one ring through all frames. What is not known is set to the mean, so that it says nothing.
struct RingFacts {
  float mean = 0;
  float floor = 0;  ///< Mean of the lowest third.
  float most = 0;
  float scatter = 0;  ///< Sum of squares about the mean.
};

RingFacts facts_of(std::span<float> powers, std::vector<float>& sorted) {
  sorted.clear();
  for (const float power : powers) {
    if (!std::isnan(power)) sorted.push_back(power);
  }
  RingFacts facts;
  if (sorted.empty()) {
    std::ranges::fill(powers, 0.0f);
    return facts;
  }
  for (const float power : sorted) facts.mean += power;
  facts.mean /= static_cast<float>(sorted.size());
  facts.most = *std::ranges::max_element(sorted);
  const std::size_t third = std::max<std::size_t>(sorted.size() / 3, 1);
  std::nth_element(sorted.begin(), sorted.begin() + (third - 1), sorted.end());
  for (std::size_t i = 0; i < third; ++i) facts.floor += sorted[i];
  facts.floor /= static_cast<float>(third);
  for (float& power : powers) {
    if (std::isnan(power)) power = facts.mean;
    facts.scatter += (power - facts.mean) * (power - facts.mean);
  }
  return facts;
}

/// White noise under the taper: so many times its mean squared, over a ring's coefficients, is the
/// variance of the ring's power.
constexpr double kTapered = 3;

/// What the lowest third of a noise's powers are in the mean, in parts of the mean of all: those of a
/// gamma distribution, by the cube root that makes it nearly normal (Wilson, Hilferty 1931).
double lowest_third(double count) {
  constexpr double kOfNormal = -1.09;
  const double spread = 2 / (9 * 2 * count / kTapered);
  return std::pow(1 - spread + kOfNormal * std::sqrt(spread), 3);
}

/// Variance of a power: of noise, and of what the law does not know of a window this small, a part of
/// what there is to explain.
float variance_of(const RingFacts& facts, double count) {
  constexpr double kUnknown = 0.25;
  const double noise = facts.floor / lowest_third(count);
  const double signal = facts.most - facts.floor;
  return static_cast<float>((kTapered * noise * noise + kUnknown * kUnknown * signal * signal) /
                            count);
}

/// Nothing is added where nothing changes.
constexpr float kNothing = 1e-12f;

}  // namespace

double StackBlur::diameter_px(double from_focus) const {
  const double blur = px_per_unit * from_focus;
  return std::sqrt(std::max(blur * blur + offset_px2, 0.0));
}

std::array<float, kRings> ring_transfer(double diameter_px, BlurShape shape) {
  std::array<float, kRings> left{};
  for (int k = 0; k < kRings; ++k) {
    double sum = 0;
    for (const double radius : ring_radii()[k]) {
      sum += squared_transfer(std::numbers::pi * diameter_px * radius, shape);
    }
    left[k] = static_cast<float>(sum / static_cast<double>(ring_radii()[k].size()));
  }
  return left;
}

const std::array<double, kRings>& ring_counts() {
  static const auto counts = [] {
    std::array<double, kRings> made{};
    for (int k = 0; k < kRings; ++k) made[k] = static_cast<double>(ring_radii()[k].size());
    return made;
  }();
  return counts;
}

MatchedFilter::MatchedFilter(const Level& level, const StackBlur& blur,
                             std::span<const double> positions, const FocusGrid& grid)
    : frames_(static_cast<int>(positions.size())), foci_(grid.size) {
  const TransferTable& table = TransferTable::of(blur.shape);
  law_.resize(static_cast<std::size_t>(kRings) * frames_ * foci_);
  std::vector<double> left(frames_);
  for (int k = 0; k < kRings; ++k) {
    float* const ring = law_.data() + static_cast<std::size_t>(k) * frames_ * foci_;
    for (int p = 0; p < foci_; ++p) {
      double mean = 0, squares = 0;
      for (int z = 0; z < frames_; ++z) {
        left[z] = table(blur.diameter_px(positions[z] - grid.at(p)) / level.scale(), k);
        mean += left[z] / frames_;
      }
      for (const double value : left) squares += (value - mean) * (value - mean);
      const double norm = 1 / std::sqrt(squares + kNothing);
      for (int z = 0; z < frames_; ++z) {
        ring[static_cast<std::size_t>(z) * foci_ + p] = static_cast<float>((left[z] - mean) * norm);
      }
    }
  }
}

template <class Take>
void MatchedFilter::each_ring(std::span<float> powers, std::span<float> sums,
                              const Take& take) const {
  thread_local std::vector<float> sorted;
  std::ranges::fill(sums, 0.0f);
  for (int k = 0; k < kRings; ++k) {
    const std::span<float> ring = powers.subspan(static_cast<std::size_t>(k) * frames_, frames_);
    const RingFacts facts = facts_of(ring, sorted);
    if (facts.scatter <= kNothing * facts.mean * facts.mean) continue;
    for (float& power : ring) power -= facts.mean;
    take(k, facts,
         RingAndLaw{.powers = ring.data(),
                    .law = law_.data() + static_cast<std::size_t>(k) * frames_ * foci_,
                    .frames = frames_,
                    .foci = foci_});
  }
}

void MatchedFilter::explain(std::span<float> powers, std::span<float> told) const {
  const std::span<float> detail = told.subspan(foci_);
  std::ranges::fill(detail, 0.0f);
  each_ring(powers, told.first(foci_), [&](int k, const RingFacts& facts, const RingAndLaw& ring) {
    const float variance = variance_of(facts, ring_counts()[k]);
    add_explained(ring, 1 / variance, told.data());
    const float weight = (facts.most - facts.floor) / variance;
    for (int z = 0; z < frames_; ++z) detail[z] += weight * ring.powers[z];
  });
}

void MatchedFilter::likeness(std::span<float> powers, std::span<float> likeness) const {
  constexpr float kAlmostAll = 0.999f;
  each_ring(powers, likeness, [&](int k, const RingFacts& facts, const RingAndLaw& ring) {
    add_likeness(ring, kAlmostAll / facts.scatter, static_cast<float>(ring_counts()[k]),
                 likeness.data());
  });
}

}  // namespace fathom::depth
