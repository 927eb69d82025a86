// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/tables.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "engine/tables.hpp"

namespace fathom::cpu {
namespace {

/// Fills the frequencies of one sub-transform: its positions hold, radix by radix, the residues of
/// the frequency.
void place(std::span<const int> radices, int frequency, int step, std::vector<int>& frequencies) {
  if (radices.empty()) {
    frequencies.push_back(frequency);
    return;
  }
  for (int q = 0; q < radices[0]; ++q) {
    place(radices.subspan(1), frequency + q * step, step * radices[0], frequencies);
  }
}

template <class T>
std::vector<T> stage_twiddles(int n) {
  std::vector<T> twiddles;
  const auto roots = tables::twiddles(n);
  const Radices stages = radices(n);
  int span = n;  // points of the sub-transforms of this stage
  for (int stage = 0; stage + 1 < stages.count; ++stage) {
    const int radix = stages.radix[stage];
    const int groups = span / radix;
    for (int s = 0; s < groups; ++s) {
      for (int q = 1; q < radix; ++q) {
        const auto root = roots[(q * s * (n / span)) % n];
        twiddles.push_back(static_cast<T>(root.real()));
        twiddles.push_back(static_cast<T>(root.imag()));
      }
    }
    span = groups;
  }
  return twiddles;
}

}  // namespace

std::vector<int> frequency_by_position(int n) {
  std::vector<int> frequencies;
  const Radices stages = radices(n);
  place(std::span(stages.radix, stages.count), 0, 1, frequencies);
  return frequencies;
}

template <class T>
FourierTables<T>::FourierTables(const MetricSpec& spec)
    : twiddle(stage_twiddles<T>(spec.n)), frequency(frequency_by_position(spec.n)) {
  const int n = spec.n;
  const auto w = tables::taper(spec.taper, n);
  const auto flat = tables::taper_spectrum(spec.taper, n);
  const auto arms = tables::lever_arms(Transform::fft, n);
  taper.assign(w.begin(), w.end());
  const double sum = std::accumulate(w.begin(), w.end(), 0.0);
  for (const double weight : w) mean_weight.push_back(static_cast<T>(weight / sum));
  double weights = 0;
  for (int k = 0; k < 8; ++k) weights += w[n / 16 + k * (n / 8)];
  for (int k = 0; k < 8; ++k) {
    sample_weight.push_back(static_cast<T>(w[n / 16 + k * (n / 8)] / weights));
  }
  position.resize(n);
  for (int p = 0; p < n; ++p) {
    const int k = frequency[p];
    position[k] = p;
    flat_re.push_back(static_cast<T>(flat[k].real() * n));
    flat_im.push_back(static_cast<T>(flat[k].imag() * n));
    is_touched.push_back(flat[k] != 0.0);
    if (flat[k] != 0.0 && k <= n / 2) touched_until = std::max(touched_until, k);
    arm.push_back(static_cast<T>(arms[k]));
  }
  double energy = 0;
  for (const auto& coefficient : flat) energy += std::norm(coefficient) * n * n;
  flat_energy = static_cast<T>(energy);
  for (int v = 0; v <= n / 2; ++v) {
    arm_by_frequency.push_back(static_cast<T>(arms[v]));
    bright_re.push_back(static_cast<T>((flat[v] / flat[0]).real()));
    bright_im.push_back(static_cast<T>((flat[v] / flat[0]).imag()));
  }
  share.assign(n / 2 + 1, T{1});
  share.front() = share.back() = T{0.5};
  if (!spec.band) return;
  for (int p = 0; p < n; ++p) {
    for (int v = 0; v <= n / 2; ++v) {
      const bool counts = spec.band->contains(spec.transform, n, arms[frequency[p]] + arms[v]);
      mask.push_back(counts ? T{1} : T{0});
    }
  }
}

// docs/metrics.md, "When float is not enough", derives all of this.
Doubt::Doubt(const MetricSpec& spec) : is_power_(spec.power) {
  const double n = spec.n, least = tables::least_trusted(spec);
  limit_ = spec.power ? least : least * least;
  per_energy_ = 1 / (4 * n * n);
  const auto flat = tables::taper_spectrum(spec.taper, spec.n);
  double touched = 0;
  for (const auto& w : flat) touched += std::abs(w);
  const double grey_level = 1 / (2 * n * flat[0].real());
  per_bright_ = std::pow(0.5 * touched * grey_level, 2) * n;
}

template struct FourierTables<float>;
template struct FourierTables<double>;

std::vector<int> walsh_index_by_position(const MetricSpec& spec) {
  const auto paley = tables::paley_index(spec.transform, spec.n);
  const auto hadamard_of_paley = tables::paley_index(Transform::walsh_hadamard, spec.n);
  std::vector<int> index(spec.n);
  for (int i = 0; i < spec.n; ++i) index[hadamard_of_paley[paley[i]]] = i;
  return index;
}

WalshTables::WalshTables(const MetricSpec& spec)
    : taper(tables::taper(spec.taper, spec.n)), index(walsh_index_by_position(spec)) {
  const int n = spec.n;
  const auto arms = tables::lever_arms(spec.transform, n);
  for (int p = 0; p < n; ++p) arm.push_back(static_cast<std::int32_t>(arms[index[p]]));
  if (!spec.band) return;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double squared = static_cast<double>(arm[i]) + arm[j];
      mask.push_back(spec.band->contains(spec.transform, n, squared) ? -1 : 0);
    }
  }
}

namespace {

std::vector<double> cosine_weights(const MetricSpec& spec) {
  switch (spec.measure) {
    case Measure::moment:
      return tables::moment_weights(spec);
    case Measure::entropy:
      return tables::entropy_weights(spec);
    case Measure::rings:
      break;  // which has slots
  }
  return {};
}

}  // namespace

CosineTables::CosineTables(const MetricSpec& spec)
    : fourier({.transform = Transform::fft, .n = spec.n, .taper = Taper::none()}),
      weights(cosine_weights(spec)),
      terms(std::accumulate(weights.begin(), weights.end(), 0.0)) {
  const auto roots = tables::twiddles(4 * spec.n);
  for (int k = 0; k < spec.n; ++k) {
    cosine.push_back(roots[k].real() / std::numbers::sqrt2);
    sine.push_back(-roots[k].imag() / std::numbers::sqrt2);
  }
}

Tables::Tables(const MetricSpec& metric) : spec(metric) {
  switch (spec.measure) {
    case Measure::moment:
    case Measure::entropy:
      break;
    case Measure::rings:
      rings = std::make_unique<const RingTables>(spec);
      break;
  }
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      fill_fourier();
      break;
    case TransformFamily::walsh:
      fill_walsh();
      break;
    case TransformFamily::cosine:
      cosine = std::make_unique<const CosineTables>(spec);
      break;
  }
}

void Tables::fill_fourier() {
  fourier_float = std::make_unique<const FourierTables<float>>(spec);
  fourier_double = std::make_unique<const FourierTables<double>>(spec);
  switch (spec.measure) {
    case Measure::moment:
      doubt = std::make_unique<const Doubt>(spec);
      break;
    case Measure::rings:
      strip_rings_float = std::make_unique<const StripRings<float>>(spec);
      strip_rings_double = std::make_unique<const StripRings<double>>(spec);
      ring_doubt = std::make_unique<const RingDoubt>(spec);
      break;
    case Measure::entropy:
      break;  // of no Fourier transform
  }
}

void Tables::fill_walsh() {
  walsh = std::make_unique<const WalshTables>(spec);
  switch (spec.measure) {
    case Measure::moment:
    case Measure::entropy:
      break;
    case Measure::rings:
      sequency_rings = std::make_unique<const SequencyRings>(spec);
      break;
  }
}

}  // namespace fathom::cpu
