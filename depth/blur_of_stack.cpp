// SPDX-License-Identifier: Apache-2.0
#include "depth/blur_of_stack.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "depth/correlate.hpp"
#include "depth/disorder.hpp"
#include "depth/parallel.hpp"

namespace fathom::depth {
namespace {

/// Ring powers of a few windows of one level, [ring][frame] of each.
struct Sample {
  const Level* level = nullptr;
  std::vector<std::vector<float>> windows;
};

/// How much more the rings change through the frames than noise does: of what has texture. 0 for a
/// window that some frame does not show.
double change_of(std::span<const float> powers, std::size_t frames) {
  constexpr double kTapered = 3;
  double most = 0;
  std::vector<float> ring(frames);
  for (int k = 0; k < kRings; ++k) {
    std::ranges::copy(powers.subspan(k * frames, frames), ring.begin());
    if (std::ranges::any_of(ring, [](float power) { return std::isnan(power); })) return 0;
    std::ranges::nth_element(ring, ring.begin() + frames / 3);
    double mean = 0, squares = 0;
    for (const float power : ring) mean += power / static_cast<double>(frames);
    for (const float power : ring) squares += (power - mean) * (power - mean);
    const double noise = kTapered * ring[frames / 3] * ring[frames / 3] / ring_counts()[k];
    if (squares > 0) most = std::max(most, squares / (noise + 1e-3 * squares));
  }
  return most;
}

/// Those with most texture of windows all over the picture.
Sample sample_of(const Scoring& scoring, std::size_t level, std::span<const std::size_t> frames) {
  constexpr std::size_t kLooked = 4000, kKeptPowers = 6000, kFewest = 40, kMost = 240;
  const std::size_t kept = std::clamp(kKeptPowers / frames.size(), kFewest, kMost);
  Sample sample{&scoring.levels()[level], {}};
  const std::size_t nodes = sample.level->nodes(),
                    every = std::max<std::size_t>(nodes / kLooked, 1);
  std::vector<std::pair<double, std::vector<float>>> looked;
  float ring[kRings];
  for (std::size_t node = every / 2; node < nodes; node += every) {
    std::vector<float> powers(kRings * frames.size());
    for (std::size_t z = 0; z < frames.size(); ++z) {
      scoring.rings(level).take(frames[z], node * kRings, ring);
      for (int k = 0; k < kRings; ++k) powers[k * frames.size() + z] = ring[k];
    }
    const double change = change_of(powers, frames.size());
    if (change > 0) looked.emplace_back(change, std::move(powers));
  }
  std::ranges::stable_sort(looked, std::greater{}, [](const auto& entry) { return entry.first; });
  // The very best are lamps and specks; an even choice of the better half is what the picture is like.
  const std::size_t half = (looked.size() + 1) / 2;
  const std::size_t step = std::max<std::size_t>(half / kept, 1);
  for (std::size_t i = 0; i < half; i += step)
    sample.windows.push_back(std::move(looked[i].second));
  return sample;
}

/// How much likelier a law makes all windows of the samples than it makes them with their frames in
/// disorder: for noise may look like a law too, and the more so the narrower its peak is.
class Likelihood {
 public:
  Likelihood(std::vector<Sample> samples, std::span<const double> positions)
      : samples_(std::move(samples)),
        positions_(positions),
        disorder_(disorder(positions.size(), 1)) {}

  double operator()(const StackBlur& blur) const {
    const FocusGrid grid = focus_grid(blur, positions_);
    double total = 0;
    for (const Sample& sample : samples_) {
      const MatchedFilter filter(*sample.level, blur, positions_, grid);
      std::vector<float> powers, likeness(grid.size);
      for (const auto& window : sample.windows) {
        powers = window;
        filter.likeness(powers, likeness);
        total += *std::ranges::max_element(likeness);
        take_in_disorder(window, powers);
        filter.likeness(powers, likeness);
        total -= *std::ranges::max_element(likeness);
      }
    }
    return total;
  }

 private:
  void take_in_disorder(std::span<const float> window, std::span<float> powers) const {
    const std::size_t frames = disorder_.size();
    for (std::size_t i = 0; i < window.size(); ++i) {
      powers[i] = window[i / frames * frames + disorder_[i % frames]];
    }
  }

  std::vector<Sample> samples_;
  std::span<const double> positions_;
  std::vector<std::size_t> disorder_;
};

double travel_of(std::span<const double> positions) {
  const auto [low, high] = std::ranges::minmax(positions);
  return high - low;
}

/// Laws to compare: blur over the whole travel from 2 px on, in steps of a quarter.
std::vector<StackBlur> coarse_laws(double travel) {
  std::vector<StackBlur> laws;
  constexpr double kLeastPx = 2, kMostPx = 250, kFactor = 1.25;
  for (double px = kLeastPx; px < kMostPx; px *= kFactor) {
    laws.push_back({px / travel, 0, BlurShape::gaussian});
  }
  return laws;
}

std::vector<StackBlur> laws_near(const StackBlur& blur) {
  std::vector<StackBlur> laws;
  for (const double factor : {0.82, 0.91, 1.0, 1.1, 1.22}) {
    for (const double offset_px2 : {-1.0, -0.4, 0.0, 1.0, 3.0}) {
      for (const BlurShape shape : {BlurShape::disc, BlurShape::gaussian}) {
        laws.push_back({blur.px_per_unit * factor, offset_px2, shape});
      }
    }
  }
  return laws;
}

StackBlur likeliest(const std::vector<StackBlur>& laws, const Likelihood& likelihood, int threads) {
  std::vector<double> found(laws.size());
  share_out(laws.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) found[i] = likelihood(laws[i]);
  });
  return laws[std::ranges::max_element(found) - found.begin()];
}

}  // namespace

FocusGrid focus_grid(const StackBlur& blur, std::span<const double> positions) {
  constexpr double kStepPx = 0.4;
  constexpr int kFewest = 48, kMost = 320, kOfFrame = 6;
  const double travel = travel_of(positions);
  const int most = std::min(kMost, kOfFrame * static_cast<int>(positions.size()));
  const auto wanted = static_cast<int>(std::min<double>(travel * blur.px_per_unit / kStepPx, most));
  const int size = (std::max(kFewest, wanted) + kFociMultiple - 1) / kFociMultiple * kFociMultiple;
  return {.low = *std::ranges::min_element(positions), .step = travel / (size - 1), .size = size};
}

StackBlur fit_blur_of_stack(const Scoring& scoring, std::span<const std::size_t> frames,
                            std::span<const double> positions, int threads) {
  std::vector<Sample> samples;
  for (std::size_t level = 0; level < scoring.levels().size(); ++level) {
    samples.push_back(sample_of(scoring, level, frames));
  }
  const Likelihood likelihood(std::move(samples), positions);
  const StackBlur coarse = likeliest(coarse_laws(travel_of(positions)), likelihood, threads);
  return likeliest(laws_near(coarse), likelihood, threads);
}

}  // namespace fathom::depth
