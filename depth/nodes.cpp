// SPDX-License-Identifier: Apache-2.0
#include "depth/nodes.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::depth {
namespace {

/// Chi-squared to natural logarithm of the likelihood.
constexpr float kHalf = 0.5f;
/// Powers of neighbouring windows and levels tell the same in part: so many times too sure is the
/// sum of what they explain.
constexpr float kToldAgain = 1.25f;
/// Noise seems to explain less than this at its best focus, 98 times in 100.
constexpr float kLeastTold = 22;
/// A peak with less than this part of the likelihood is a guess.
constexpr float kLeastConfidence = 0.5f;

/// Part of the likelihood between the valleys beside a peak.
float part_of(std::span<const float> profile, std::size_t peak) {
  const auto likelihood = [&](std::size_t i) {
    return std::exp((profile[i] - profile[peak]) * (kHalf / kToldAgain));
  };
  float all = 0, inside = 0;
  for (std::size_t i = 0; i < profile.size(); ++i) all += likelihood(i);
  std::size_t low = peak, high = peak;
  while (low > 0 && profile[low - 1] <= profile[low]) --low;
  while (high + 1 < profile.size() && profile[high + 1] <= profile[high]) ++high;
  for (std::size_t i = low; i <= high; ++i) inside += likelihood(i);
  return inside / all;
}

}  // namespace

Peak peak_of(std::span<const float> profile) {
  const std::size_t best = std::ranges::max_element(profile) - profile.begin();
  Peak peak{.place = static_cast<float>(best), .told = profile[best]};
  if (!(profile[best] >= kLeastTold)) return peak;
  if (best == 0 || best + 1 == profile.size()) {
    peak.kind = DepthClass::at_end;
    return peak;
  }
  const float before = profile[best - 1], here = profile[best], after = profile[best + 1];
  const float bend = 2 * here - before - after;
  if (!(bend > 0)) return peak;
  peak.place += kHalf * (after - before) / bend;
  peak.sigma = std::sqrt(2 * kToldAgain / bend);
  peak.confidence = part_of(profile, best);
  peak.kind = peak.confidence >= kLeastConfidence ? DepthClass::known : DepthClass::no_texture;
  return peak;
}

}  // namespace fathom::depth
