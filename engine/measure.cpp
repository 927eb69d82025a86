// SPDX-License-Identifier: Apache-2.0
#include "engine/measure.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "engine/tables.hpp"

namespace fathom {
namespace {

constexpr Band kWholeBand{0, 0.5};

std::size_t place_of(int n, int row, int col) { return static_cast<std::size_t>(row) * n + col; }

/// Index, from zero frequency on, of a row or column of a spectrum as Plan::spectrum stores it.
int index_of(TransformFamily family, int n, int place) {
  switch (family) {
    case TransformFamily::fourier:
      return place - n / 2;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return place;
  }
  return place;
}

/// Calls body(row index, column index, place) for the whole plane.
template <class Body>
void for_each_coefficient(const MetricSpec& spec, const Body& body) {
  const TransformFamily family = family_of(spec.transform);
  for (int row = 0; row < spec.n; ++row) {
    for (int col = 0; col < spec.n; ++col) {
      body(index_of(family, spec.n, row), index_of(family, spec.n, col),
           place_of(spec.n, row, col));
    }
  }
}

double mass_of(const MetricSpec& spec, std::complex<double> coefficient) {
  return spec.power ? std::norm(coefficient) : std::abs(coefficient);
}

/// A moment sums half of the plane for fft (eq. 5-1), all of it for the others (eq. 5-2).
double part_of_plane(TransformFamily family) {
  switch (family) {
    case TransformFamily::fourier:
      return 0.5;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return 1;
  }
  return 1;
}

}  // namespace

Rings::Rings(const MetricSpec& spec)
    : cycles_per_index_(cycles_per_index(spec.transform).value()), coefficients_(spec.rings) {
  const Band band = spec.band.value_or(kWholeBand);
  for (int k = 0; k <= spec.rings; ++k) {
    const double edge = (band.low + (band.high - band.low) * k / spec.rings) * spec.n;
    squared_edges_.push_back(edge * edge);
  }
  for_each_coefficient(spec, [this](int row, int col, std::size_t) {
    const int ring = of(row, col);
    if (ring != kNone) ++coefficients_[ring];
  });
}

int Rings::of(int row, int col) const {
  const double squared = (static_cast<double>(row) * row + static_cast<double>(col) * col) *
                         (cycles_per_index_ * cycles_per_index_);
  // The first edge that is not below r: ring k ends at edge k + 1.
  const auto end = std::lower_bound(squared_edges_.begin(), squared_edges_.end(), squared);
  if (end == squared_edges_.begin() || end == squared_edges_.end()) return kNone;
  return static_cast<int>(end - squared_edges_.begin()) - 1;
}

bool Rings::has_all() const {
  return std::ranges::all_of(coefficients_, [](std::uint32_t count) { return count > 0; });
}

SpectrumMeasure::SpectrumMeasure(const MetricSpec& spec) : spec_(spec), sums_(spec.outputs()) {
  switch (spec.measure) {
    case Measure::moment:
      return;
    case Measure::entropy:
      weights_ = tables::entropy_weights(spec);
      return;
    case Measure::rings:
      const Rings rings(spec);
      counts_.assign(rings.coefficients().begin(), rings.coefficients().end());
      for_each_coefficient(spec, [&](int row, int col, std::size_t) {
        ring_of_.push_back(static_cast<std::int8_t>(rings.of(row, col)));
      });
      if (spec.subtracts_mean()) taper_ = tables::taper_spectrum(spec.taper, spec.n);
  }
}

void SpectrumMeasure::operator()(std::span<const std::complex<double>> coefficients,
                                 std::span<double> values) {
  switch (spec_.measure) {
    case Measure::moment:
      values[0] = moment_of(coefficients);
      return;
    case Measure::rings:
      return ring_means(coefficients, values);
    case Measure::entropy:
      values[0] = entropy_of(coefficients);
      return;
  }
}

double SpectrumMeasure::moment_of(std::span<const std::complex<double>> coefficients) const {
  long double moment = 0;
  for_each_coefficient(spec_, [&](int row, int col, std::size_t place) {
    const double arm = static_cast<double>(row) * row + static_cast<double>(col) * col;
    if (spec_.band && !spec_.band->contains(spec_.transform, spec_.n, arm)) return;
    moment += static_cast<long double>(mass_of(spec_, coefficients[place])) * arm;
  });
  const double n4 = std::pow(spec_.n, 4);
  return static_cast<double>(moment / n4 * part_of_plane(family_of(spec_.transform)));
}

void SpectrumMeasure::ring_means(std::span<const std::complex<double>> coefficients,
                                 std::span<double> values) {
  std::ranges::fill(sums_, 0);
  const std::size_t zero = place_of(spec_.n, spec_.n / 2, spec_.n / 2);
  const std::complex<double> mean =
      taper_.empty() ? 0 : coefficients[zero] / (taper_[0] * taper_[0]);
  for_each_coefficient(spec_, [&](int row, int col, std::size_t place) {
    const int ring = ring_of_[place];
    if (ring == Rings::kNone) return;
    std::complex<double> coefficient = coefficients[place];
    if (!taper_.empty()) coefficient -= mean * mean_at(row, col);
    sums_[ring] += mass_of(spec_, coefficient);
  });
  for (std::size_t k = 0; k < sums_.size(); ++k) values[k] = mean_of(sums_[k], counts_[k]);
}

/// Coefficients of an entropy are stored in the order of their indices, as its weights are.
double SpectrumMeasure::entropy_of(std::span<const std::complex<double>> coefficients) const {
  long double energy = 0, terms = 0, count = 0;
  for (const std::complex<double>& c : coefficients) energy += std::norm(c);
  if (energy == 0) return 0;
  const long double norm = std::sqrt(energy);
  for (std::size_t place = 0; place < coefficients.size(); ++place) {
    count += weights_[place];
    const long double p = std::abs(coefficients[place]) / norm;
    if (p > 0) terms -= weights_[place] * p * std::log2(p);
  }
  return static_cast<double>(terms / count);
}

/// What a constant of 1 under the taper has at (u, v): W(u) W(v).
std::complex<double> SpectrumMeasure::mean_at(int v, int u) const {
  const auto wrapped = [this](int index) {
    return static_cast<std::size_t>(index < 0 ? index + spec_.n : index);
  };
  return taper_[wrapped(v)] * taper_[wrapped(u)];
}

/// Where N^2 |W| are whole numbers, their mean is rounded once.
double SpectrumMeasure::mean_of(long double sum, std::uint32_t count) const {
  if (!spec_.is_exact()) return static_cast<double>(sum / count);
  const double pixels = static_cast<double>(spec_.n) * spec_.n;
  return static_cast<double>(sum * pixels) / (count * pixels);
}

}  // namespace fathom
