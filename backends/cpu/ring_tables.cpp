// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/ring_tables.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "backends/cpu/tables.hpp"
#include "engine/measure.hpp"
#include "engine/tables.hpp"

namespace fathom::cpu {
namespace {

/// The index, from zero frequency on, of the coefficient at each position.
std::vector<int> index_by_position(const MetricSpec& spec) {
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier: {
      auto indices = frequency_by_position(spec.n);
      for (int& k : indices) k = std::min(k, spec.n - k);
      return indices;
    }
    case TransformFamily::walsh:
      return walsh_index_by_position(spec);
    case TransformFamily::cosine: {
      std::vector<int> indices(spec.n);
      std::iota(indices.begin(), indices.end(), 0);
      return indices;
    }
  }
  return {};
}

/// The part of a mean and of what rounding pixels leaves in it that noise may have: the tolerance
/// but for a tenth, which is left to what is rounded in proportion.
constexpr double kTrusted = 0.9e-5;

/// How often the whole plane holds what a kernel sums.
double times_in_plane(const MetricSpec& spec) {
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      return 2;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return 1;
  }
  return 1;
}

}  // namespace

RingTables::RingTables(const MetricSpec& spec) : count(spec.rings) {
  const Rings rings(spec);
  const double scale = tables::coefficient_scale(spec.transform, spec.n);
  const double mass_scale = times_in_plane(spec) * (spec.power ? scale * scale : scale);
  for (const std::uint32_t n : rings.coefficients()) {
    coefficients.push_back(n);
    factor.push_back(mass_scale / n);
  }
  const std::vector<int> index = index_by_position(spec);
  for (const int row : index) {
    for (const int col : index) {
      const int ring = rings.of(row, col);
      slot.push_back(static_cast<std::uint8_t>(ring == Rings::kNone ? count : ring));
    }
  }
}

namespace {

/// What a layer moves of column u, which is the row that `depth` others of the same ring precede.
template <class T>
typename RingLayers<T>::Move move_of(const Rings& rings, int half, int strip, int k, int u,
                                     int depth) {
  constexpr int lanes = RingLayers<T>::kLanes;
  typename RingLayers<T>::Move move{};
  int seen[lanes] = {};
  for (int lane = 0; lane < lanes; ++lane) {
    const int v = 1 + strip * lanes + lane;
    const int ring = v <= half ? rings.of(v, u) : Rings::kNone;
    if (ring == Rings::kNone || ring < k || ring >= k + lanes) continue;
    if (seen[ring - k]++ != depth) continue;
    move.from[ring - k] = lane;
    move.share[ring - k] = static_cast<T>(v == half ? 0.5 : 1);
  }
  return move;
}

}  // namespace

template <class T>
RingLayers<T>::RingLayers(const MetricSpec& spec)
    : half_(spec.n / 2), registers_((spec.rings + kLanes - 1) / kLanes), parts_{0} {
  const Rings rings(spec);
  for (int strip = 0; strip * kLanes < half_; ++strip) {
    for (int k = 0; k < spec.rings; k += kLanes) add_layers(rings, strip, k);
  }
}

template <class T>
bool RingLayers<T>::suit(const MetricSpec& spec) {
  const double width = spec.band ? spec.band->high - spec.band->low : 0.5;
  // What larger windows move would not stay in the nearest cache.
  return spec.n <= 32 && width * spec.n <= spec.rings;
}

template <class T>
void RingLayers<T>::add_layers(const Rings& rings, int strip, int k) {
  for (int depth = 0;; ++depth) {
    std::vector<Move> moves(half_ + 2);
    Layer layer;
    for (int u = 0; u <= half_; ++u) {
      moves[u] = move_of<T>(rings, half_, strip, k, u, depth);
      if (std::ranges::count(moves[u].share, T{0}) == kLanes) continue;
      if (layer.end == 0) layer.first = u;
      layer.end = u + 1;
    }
    if (layer.end == 0) break;
    layer.end += (layer.end - layer.first) % 2;
    layer.moves = moves_.size();
    moves_.insert(moves_.end(), moves.begin() + layer.first, moves.begin() + layer.end);
    layers_.push_back(layer);
  }
  parts_.push_back(layers_.size());
}

template class RingLayers<float>;
template class RingLayers<double>;

template <class T>
StripRings<T>::StripRings(const MetricSpec& spec)
    : count_(spec.rings),
      half_(spec.n / 2),
      lines_per_row_(static_cast<int>((half_ * sizeof(T) + sizeof(Line) - 1) / sizeof(Line))),
      lines_(static_cast<std::size_t>(half_ + 2) * lines_per_row_) {
  const Rings rings(spec);
  for (int u = 0; u <= half_ + 1; ++u) {
    T* const line = lines_[u * lines_per_row_].lane;
    for (int v = 1; v <= half_; ++v) {
      line[v - 1] = static_cast<T>(u <= half_ ? rings.of(v, u) : Rings::kNone);
    }
  }
  for (int lanes = 2; lanes <= 16; lanes *= 2) runs_[index_of(lanes)] = runs(lanes);
  zero_row_.resize(count_);
  for (int u = 0; u <= half_; ++u) {
    const int ring = rings.of(0, u);
    if (ring != Rings::kNone) extend(zero_row_[ring], u);
  }
  if (RingLayers<T>::suit(spec)) layers_.emplace(spec);
}

template <class T>
void StripRings<T>::extend(Run& run, int u) {
  if (run.end == 0) run.first = static_cast<std::int16_t>(u);
  run.end = static_cast<std::int16_t>(u + 1);
}

template <class T>
std::vector<typename StripRings<T>::Run> StripRings<T>::runs(int lanes) const {
  std::vector<Run> runs(static_cast<std::size_t>((half_ + lanes - 1) / lanes) * count_);
  for (int u = 0; u <= half_; ++u) {
    for (int v = 1; v <= half_; ++v) {
      const int ring = static_cast<int>(row(u)[v - 1]);
      if (ring != Rings::kNone) extend(runs[(v - 1) / lanes * count_ + ring], u);
    }
  }
  for (Run& run : runs) run.end = static_cast<std::int16_t>(run.end + (run.end - run.first) % 2);
  return runs;
}

template class StripRings<float>;
template class StripRings<double>;

SequencyRings::SequencyRings(const MetricSpec& spec)
    : edges(spec.rings + 1), start(static_cast<std::size_t>(edges) * spec.n) {
  const Rings rings(spec);
  const std::vector<int> index = walsh_index_by_position(spec);
  for (int p = 0; p < spec.n; ++p) {
    std::vector<std::int32_t> counts(spec.rings, 0);
    int first = 0, seen = 0;
    for (int j = 0; j < spec.n; ++j) {
      const int ring = rings.of(index[p], j);
      if (ring == Rings::kNone) continue;
      if (seen++ == 0) first = j;
      ++counts[ring];
    }
    start[p] = first;
    for (int k = 0; k < spec.rings; ++k) {
      start[(k + 1) * spec.n + p] = start[k * spec.n + p] + counts[k];
    }
  }
}

namespace {

/// [k] how many times the noise of an even spread a ring's mean may have, at least 1: rounding that
/// is alike in all columns or rows stays in few lines of the plane, and that of what the mean was
/// near stays next to zero frequency (docs/metrics.md, "Rings in float").
std::vector<double> noise_concentration(const MetricSpec& spec) {
  const Rings rings(spec);
  std::vector<double> in_lines(spec.rings), next_to_zero(spec.rings);
  for (int v = -spec.n / 2; v < spec.n / 2; ++v) {
    for (int u = -spec.n / 2; u < spec.n / 2; ++u) {
      const int ring = rings.of(std::abs(v), std::abs(u));
      if (ring == Rings::kNone) continue;
      const bool is_in_row = std::abs(v) <= 1, is_in_column = std::abs(u) <= 1;
      in_lines[ring] += is_in_row || is_in_column;
      next_to_zero[ring] += is_in_row && is_in_column;
    }
  }
  // Squares of small means gain nothing from noise that is not in phase with them.
  const double most_next_to_zero = (spec.power ? 0.25 : 0.5) * spec.n;
  std::vector<double> concentration;
  for (int k = 0; k < spec.rings; ++k) {
    const double count = rings.coefficients()[k];
    concentration.push_back(std::max({1.0, 0.9 * std::sqrt(spec.n * in_lines[k] / count),
                                      most_next_to_zero * next_to_zero[k] / count}));
  }
  return concentration;
}

/// Of `power`, and soon told for most pictures: whether every value V is above (2.1 |dF| / t)^2.
/// Then 2 |dF| sqrt(V) + |dF|^2 < t V.
bool are_far_above(std::span<const double> values, double noise,
                   std::span<const double> squared_spread) {
  const double far = 2.1 * 2.1 / (kTrusted * kTrusted) * noise;
  bool are_far = true;
  for (std::size_t k = 0; k < values.size(); ++k) are_far &= values[k] >= far * squared_spread[k];
  return are_far;
}

}  // namespace

RingDoubt::RingDoubt(const MetricSpec& spec) : is_power_(spec.power) {
  const double n = spec.n;
  double weights = 0;  // SUM w^2 along an axis
  for (const double w : tables::taper(spec.taper, spec.n)) weights += w * w;
  // kFloatNoise C / N^2 with C^2 = energy / (4 N^2).
  per_energy_ = std::pow(tables::kFloatNoise / (2 * n * n * n), 2);
  const double quantum = weights / (std::sqrt(12.0) * n * n);
  quantum_ = spec.power ? quantum * quantum : quantum;
  for (const double times : noise_concentration(spec)) squared_spread_.push_back(times * times);
}

// All squared, so that no root is taken.
bool RingDoubt::about(std::span<const double> values, double energy) const {
  const double noise = energy * per_energy_;
  double sum = noise;
  for (const double value : values) sum += value;
  if (!std::isfinite(sum)) return true;
  if (is_power_ && are_far_above(values, noise, squared_spread_)) return false;
  bool is_trusted = true;
  for (std::size_t k = 0; k < values.size(); ++k) {
    is_trusted &= is_power_ ? allows_power(values[k], noise, squared_spread_[k])
                            : allows_magnitude(values[k], noise * squared_spread_[k]);
  }
  return !is_trusted;
}

bool RingDoubt::allows_magnitude(double value, double noise) const {
  const double allowed = kTrusted * (value + quantum_);
  return noise <= allowed * allowed;
}

bool RingDoubt::allows_power(double value, double noise, double squared_spread) const {
  const double of_ring = noise * squared_spread;
  const double rest = kTrusted * (value + quantum_) - of_ring;
  return rest >= 0 && 4 * value * of_ring <= rest * rest;
}

}  // namespace fathom::cpu
