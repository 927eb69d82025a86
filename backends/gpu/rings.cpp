// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/rings.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "backends/gpu/tables.hpp"
#include "engine/measure.hpp"
#include "engine/tables.hpp"

namespace fathom::gpu {
namespace {

/// Four bytes a word, the first one lowest.
std::vector<std::uint32_t> packed(const std::vector<std::uint8_t>& bytes) {
  std::vector<std::uint32_t> words((bytes.size() + 3) / 4);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    words[i / 4] |= std::uint32_t{bytes[i]} << (8 * (i % 4));
  }
  return words;
}

/// How many indices from zero frequency the coefficient at each position is.
std::vector<int> distance_by_position(const MetricSpec& spec) {
  auto index = index_by_position(spec);
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      for (int& k : index) k = std::min(k, spec.n - k);
      break;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      break;
  }
  return index;
}

/// [k] how many coefficients of one row v of the plane lie in ring k.
std::vector<double> row_counts(const Rings& rings, int n, int v) {
  std::vector<double> counts(rings.count());
  for (int u = 0; u < n; ++u) {
    const int ring = rings.of(v, std::min(u, n - u));
    if (ring != Rings::kNone) ++counts[ring];
  }
  return counts;
}

/// [k] how many times its share of the noise a ring may hold. A picture of stripes is rounded alike
/// in all of its columns, and all noise is in one row of its plane. Stripes along an axis have it
/// in the row v = 0, and there not evenly: pictures bred for their error held nearly four times as
/// much.
std::vector<double> crowding(const Rings& rings, int n) {
  constexpr double kUneven = 4;
  std::vector<double> crowding(rings.count(), 1);
  for (int v = 0; v <= n / 2; ++v) {
    const auto row = row_counts(rings, n, v);
    for (int k = 0; k < rings.count(); ++k) {
      const double crowd = n * row[k] / rings.coefficients()[k];
      crowding[k] = std::max(crowding[k], v == 0 ? kUneven * crowd : crowd);
    }
  }
  return crowding;
}

/// [k] SUM |f| over ring k, or with `power` the root of SUM |f|^2, of a flat window of one grey
/// level in the units of the kernel, 2 N^2 F, over half of the plane.
std::vector<double> flat_sums(const MetricSpec& spec, const Rings& rings) {
  const auto flat = tables::taper_spectrum(spec.taper, spec.n);
  std::vector<double> sums(rings.count());
  for (int v = 0; v < spec.n; ++v) {
    for (int u = 0; u < spec.n; ++u) {
      const int ring = rings.of(std::min(v, spec.n - v), std::min(u, spec.n - u));
      if (ring == Rings::kNone) continue;
      const double f = 2.0 * spec.n * spec.n * std::abs(flat[u] * flat[v]);
      sums[ring] += (spec.power ? f * f : f) / 2;
    }
  }
  if (spec.power) {
    for (double& sum : sums) sum = std::sqrt(sum);
  }
  return sums;
}

}  // namespace

std::vector<RingRule> ring_rules(const MetricSpec& spec) {
  constexpr double kSigmas = 8;  // as of the moment (tables.cpp)
  const auto taper = tables::taper(spec.taper, spec.n);
  const double squares = std::inner_product(taper.begin(), taper.end(), taper.begin(), 0.0);
  const Rings rings(spec);
  const auto crowds = crowding(rings, spec.n);
  const auto flat = flat_sums(spec, rings);
  // Two table entries, three operations of their product and the difference round once each.
  constexpr double kRounding = 6 * 0x1p-24;
  std::vector<RingRule> rules;
  for (int k = 0; k < rings.count(); ++k) {
    const double count = rings.coefficients()[k], half = count / 2;
    const double crowd = crowds[k], amplitude = std::sqrt(crowd);
    // What is left of a grey level of variance 1/12 in 2 N^2 |F|, which is 2 sqrt(SUM w^2 / 12).
    const double quantum = squares / std::sqrt(3.0);
    if (spec.power) {
      // In phase with the picture by Cauchy-Schwarz; of random phase one part of two counts.
      const double lead = std::min(2 * std::sqrt(half), kSigmas * std::sqrt(2.0));
      rules.push_back({.lead = amplitude * lead,
                       .rest = 2 * crowd * half,
                       .floor = half * quantum * quantum,
                       .brightness = kRounding * flat[k]});
    } else {
      const double spread = kSigmas * std::sqrt(half / 2);
      rules.push_back({.lead = amplitude * half,
                       .rest = amplitude * spread,
                       .floor = half * quantum,
                       .brightness = kRounding * flat[k]});
    }
  }
  return rules;
}

std::vector<std::uint32_t> ring_words_by_frequency(const MetricSpec& spec) {
  const Rings rings(spec);
  const int half = spec.n / 2;
  std::vector<std::uint8_t> bytes;
  for (int u = 0; u <= half; ++u) {
    for (int v = 0; v < half + FATHOM_RING_MARGIN; ++v) {
      const int ring = v <= half ? rings.of(v, u) : Rings::kNone;
      bytes.push_back(static_cast<std::uint8_t>(ring == Rings::kNone ? spec.rings + 2 : ring));
    }
  }
  return packed(bytes);
}

std::vector<std::uint32_t> ring_words_by_position(const MetricSpec& spec) {
  const Rings rings(spec);
  const auto distance = distance_by_position(spec);
  std::vector<std::uint8_t> bytes;
  for (const int row : distance) {
    for (const int column : distance) {
      const int ring = rings.of(row, column);
      bytes.push_back(static_cast<std::uint8_t>(ring == Rings::kNone ? spec.rings : ring));
    }
  }
  return packed(bytes);
}

}  // namespace fathom::gpu
