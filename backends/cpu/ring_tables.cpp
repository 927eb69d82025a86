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
      lines_(static_cast<std::size_t>(half_ + 1) * lines_per_row_) {
  const Rings rings(spec);
  for (int u = 0; u <= half_; ++u) {
    T* const line = lines_[u * lines_per_row_].lane;
    for (int v = 1; v <= half_; ++v) line[v - 1] = static_cast<T>(rings.of(v, u));
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
  return runs;
}

template class StripRings<float>;
template class StripRings<double>;

SequencyRings::SequencyRings(const MetricSpec& spec) : edges(spec.rings + 1) {
  const Rings rings(spec);
  for (const int i : walsh_index_by_position(spec)) {
    std::vector<std::int32_t> counts(spec.rings, 0);
    int first = 0, seen = 0;
    for (int j = 0; j < spec.n; ++j) {
      const int ring = rings.of(i, j);
      if (ring == Rings::kNone) continue;
      if (seen++ == 0) first = j;
      ++counts[ring];
    }
    start.push_back(first);
    for (const std::int32_t count : counts) start.push_back(start.back() + count);
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
    spread_.push_back(std::min(1.0, kDeviations / std::sqrt(count)));
  }
}

bool RingDoubt::about(std::span<const double> values, double energy) const {
  const double noise = std::sqrt(energy * per_energy_);
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!allows(values[k], noise, k)) return true;
  }
  return false;
}

bool RingDoubt::allows(double value, double noise, std::size_t ring) const {
  const double tolerance = kTolerance * (value + quantum_);
  if (!is_power_) return noise <= tolerance;
  return 2 * std::sqrt(value) * noise * spread_[ring] + noise * noise <= tolerance;
}

}  // namespace fathom::cpu
