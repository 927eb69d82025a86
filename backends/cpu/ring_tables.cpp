// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/ring_tables.hpp"

#include <algorithm>
#include <cmath>

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
  }
  return {};
}

/// Of a mean and what rounding pixels leaves in it (docs/metrics.md, "Rings").
constexpr double kTolerance = 1e-5;

/// How often the whole plane holds what a kernel sums.
double times_in_plane(const MetricSpec& spec) {
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      return 2;
    case TransformFamily::walsh:
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

RingDoubt::RingDoubt(const MetricSpec& spec) : is_power_(spec.power) {
  const double n = spec.n;
  double weights = 0;  // SUM w^2 along an axis
  for (const double w : tables::taper(spec.taper, spec.n)) weights += w * w;
  // kFloatNoise C / N^2 with C^2 = energy / (4 N^2).
  per_energy_ = std::pow(tables::kFloatNoise / (2 * n * n * n), 2);
  const double quantum = weights / (std::sqrt(12.0) * n * n);
  quantum_ = spec.power ? quantum * quantum : quantum;
  constexpr double kDeviations = 4;
  for (const std::uint32_t count : Rings(spec).coefficients()) {
    squared_spread_.push_back(4 * std::min(1.0, kDeviations * kDeviations / count));
  }
}

// All squared, so that no root is taken.
bool RingDoubt::about(std::span<const double> values, double energy) const {
  const double noise = energy * per_energy_;
  double least = values[0], sum = 0;
  for (const double value : values) least = std::min(least, value), sum += value;
  if (!std::isfinite(sum)) return true;
  if (!is_power_) return !allows_magnitude(least, noise);
  // Where the bound for one coefficient grows slower than what is allowed, the least ring decides.
  if (noise <= kTolerance * kTolerance * least && allows_power(least, noise, 4)) return false;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!allows_power(values[k], noise, squared_spread_[k])) return true;
  }
  return false;
}

bool RingDoubt::allows_magnitude(double value, double noise) const {
  const double allowed = kTolerance * (value + quantum_);
  return noise <= allowed * allowed;
}

bool RingDoubt::allows_power(double value, double noise, double squared_spread) const {
  const double rest = kTolerance * (value + quantum_) - noise;
  return rest >= 0 && squared_spread * value * noise <= rest * rest;
}

}  // namespace fathom::cpu
