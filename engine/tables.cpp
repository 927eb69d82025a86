// SPDX-License-Identifier: Apache-2.0
#include "engine/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/error.hpp"

namespace fathom::tables {
namespace {

constexpr double kPi = std::numbers::pi;

/// exp(-2 pi i k/n) by symmetry from the first octant, where sin and cos round best.
std::complex<double> unit_root(int k, int n) {
  k = ((k % n) + n) % n;
  if (2 * k > n) return std::conj(unit_root(n - k, n));
  if (4 * k > n) {
    const auto mirrored = unit_root(n / 2 - k, n);  // n is even wherever k > n/4 can occur here
    return {-mirrored.real(), mirrored.imag()};
  }
  if (8 * k > n) {
    const double angle = 2 * kPi * (n / 4.0 - k) / n;
    return {std::sin(angle), -std::cos(angle)};
  }
  const double angle = 2 * kPi * k / n;
  return {std::cos(angle), -std::sin(angle)};
}

int bit_reversed(int value, int n) {
  int reversed = 0;
  for (int bit = 1; bit < n; bit <<= 1) {
    reversed = (reversed << 1) | (value & 1);
    value >>= 1;
  }
  return reversed;
}

}  // namespace

std::vector<double> taper(Taper taper, int n) {
  std::vector<double> w(static_cast<std::size_t>(n), 1.0);
  const double edge = taper.cosine_fraction * n / 2;  // width of one flank in pixels
  for (int x = 0; x < n; ++x) {
    const double from_edge = std::min(x, n - 1 - x) + 0.5;
    if (from_edge < edge) w[x] = 0.5 * (1 - std::cos(kPi * from_edge / edge));
  }
  return w;
}

std::vector<std::complex<double>> taper_spectrum(Taper shape, int n) {
  std::vector<std::complex<double>> spectrum(static_cast<std::size_t>(n));
  if (shape == Taper::none()) {
    spectrum[0] = 1;
    return spectrum;
  }
  if (shape == Taper::hann()) {
    // Closed form: the half-sample offset turns the two side coefficients by half a step.
    spectrum[0] = 0.5;
    spectrum[1] = -0.25 * std::polar(1.0, kPi / n);
    spectrum[n - 1] = std::conj(spectrum[1]);
    return spectrum;
  }
  const auto w = taper(shape, n);
  const auto root = twiddles(n);
  for (int u = 0; u < n; ++u) {
    std::complex<double> sum = 0;
    for (int x = 0; x < n; ++x) sum += w[x] * root[(u * x) % n];
    spectrum[u] = sum / static_cast<double>(n);
  }
  return spectrum;
}

std::vector<std::complex<double>> twiddles(int n) {
  std::vector<std::complex<double>> roots;
  roots.reserve(n);
  for (int k = 0; k < n; ++k) roots.push_back(unit_root(k, n));
  return roots;
}

namespace {

int paley_of(Transform walsh, int i, int n) {
  switch (walsh) {
    case Transform::walsh_paley:
      return i;
    case Transform::walsh_sequency:
      return i ^ (i >> 1);
    case Transform::walsh_hadamard:
      return bit_reversed(i, n);
    case Transform::fft:
    case Transform::dct:
      break;
  }
  throw Error(ErrorCode::bad_argument, fmt::format("{} has no Walsh order", to_string(walsh)));
}

/// Distance from zero frequency, in indices, of what is stored at k.
int frequency_of(TransformFamily family, int k, int n) {
  switch (family) {
    case TransformFamily::fourier:
      return k >= n / 2 ? k - n : k;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return k;
  }
  return k;
}

}  // namespace

std::vector<int> paley_index(Transform walsh, int n) {
  std::vector<int> index(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) index[i] = paley_of(walsh, i, n);
  return index;
}

std::vector<double> lever_arms(Transform transform, int n) {
  std::vector<double> arms(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) {
    const double frequency = frequency_of(family_of(transform), k, n);
    arms[k] = frequency * frequency;
  }
  return arms;
}

std::vector<double> moment_weights(const MetricSpec& spec) {
  const int n = spec.n;
  const auto arms = lever_arms(spec.transform, n);
  std::vector<double> weights(static_cast<std::size_t>(n) * n);
  for (int row = 0; row < n; ++row) {
    for (int col = 0; col < n; ++col) {
      const double squared_radius = arms[row] + arms[col];
      const bool counts = !spec.band || spec.band->contains(spec.transform, n, squared_radius);
      weights[static_cast<std::size_t>(row) * n + col] = counts ? squared_radius : 0;
    }
  }
  return weights;
}

std::vector<double> entropy_weights(const MetricSpec& spec) {
  // The lever arm of zero frequency is 0, and so are all outside the band.
  std::vector<double> weights = moment_weights(spec);
  std::ranges::transform(weights, weights.begin(), [](double arm) { return arm > 0 ? 1.0 : 0.0; });
  return weights;
}

double least_trusted(const MetricSpec& spec) {
  constexpr double kRelative = kFloatNoise / kFloatTolerance;
  const auto arms = lever_arms(Transform::fft, spec.n);
  const double sum = std::accumulate(arms.begin(), arms.end(), 0.0);  // S
  const double impulse = sum / std::pow(spec.n, spec.power ? 7 : 5);  // phi_1
  return (spec.power ? kRelative * kRelative : kRelative) * impulse;
}

}  // namespace fathom::tables
