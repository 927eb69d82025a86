// SPDX-License-Identifier: Apache-2.0
// Spectra of whole pictures, and the little maths that the property tests hold them against.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <vector>

#include "engine/backend.hpp"
#include "tests/support/canary.hpp"

namespace fathom::conformance {

using Coefficient = std::complex<double>;

/// N x N coefficients as Plan::spectrum stores them.
class Spectrum {
 public:
  explicit Spectrum(int n) : n_(n), values_(static_cast<std::size_t>(n) * n) {}

  int n() const { return n_; }
  Coefficient& at(int row, int col) { return values_[static_cast<std::size_t>(row) * n_ + col]; }
  const Coefficient& at(int row, int col) const {
    return values_[static_cast<std::size_t>(row) * n_ + col];
  }
  /// F(u,v) of a centred Fourier spectrum; u and v wrap at N.
  const Coefficient& frequency(int u, int v) const {
    return at(wrap(v + n_ / 2), wrap(u + n_ / 2));
  }
  Coefficient& frequency(int u, int v) { return at(wrap(v + n_ / 2), wrap(u + n_ / 2)); }

  const std::vector<Coefficient>& values() const { return values_; }
  std::vector<Coefficient>& values() { return values_; }

 private:
  int wrap(int k) const { return ((k % n_) + n_) % n_; }

  int n_;
  std::vector<Coefficient> values_;
};

/// The plan's spectrum of a window; fails if the plan wrote beyond it.
inline Spectrum spectrum_of(Plan& plan, const Frame& frame, const Window& window) {
  Spectrum spectrum(window.n);
  test::Guarded<Coefficient> output(spectrum.values().size());
  plan.spectrum(frame, window, output.span());
  EXPECT_TRUE(output.intact()) << "spectrum() wrote beyond its output";
  spectrum.values().assign(output.span().begin(), output.span().end());
  return spectrum;
}

inline Spectrum spectrum_of(Plan& plan, const Frame& frame) {
  return spectrum_of(plan, frame, {0, 0, plan.spec().n});
}

/// exp(2 pi i turns).
inline Coefficient turned(double turns) { return std::polar(1.0, 2 * std::numbers::pi * turns); }

/// w(x) of thesis T3.
inline double taper_at(const MetricSpec& spec, int x) {
  const double flank = spec.taper.cosine_fraction * spec.n / 2;
  const double distance = std::min(x, spec.n - 1 - x) + 0.5;
  return distance < flank ? (1 - std::cos(std::numbers::pi * distance / flank)) / 2 : 1;
}

/// wal_i(x) in the metric's order, by the definition with sign bits (thesis T5).
inline int walsh_at(const MetricSpec& spec, int i, int x) {
  const int bits = static_cast<int>(std::lround(std::log2(spec.n)));
  if (spec.transform == Transform::walsh_sequency) i ^= i >> 1;
  int negative = 0;
  for (int bit = 0; bit < bits; ++bit) {
    const int other = spec.transform == Transform::walsh_hadamard ? bit : bits - 1 - bit;
    negative ^= ((i >> bit) & (x >> other)) & 1;
  }
  return negative ? -1 : 1;
}

/// e(i) cos(pi i (2 x + 1)/(2 N)), e(0) = 1, else the root of 2.
inline double cosine_at(const MetricSpec& spec, int i, int x) {
  const double wave = std::cos(std::numbers::pi * i * (2 * x + 1) / (2 * spec.n));
  return i == 0 ? 1 : std::numbers::sqrt2 * wave;
}

/// Bits per coefficient, from the coefficients.
inline double entropy_of(const MetricSpec& spec, const Spectrum& spectrum) {
  double energy = 0, bits = 0;
  int terms = 0;
  for (const Coefficient& c : spectrum.values()) energy += std::norm(c);
  for (int row = 0; row < spec.n; ++row) {
    for (int col = 0; col < spec.n; ++col) {
      const double squared = std::pow(row, 2) + std::pow(col, 2);
      if (squared == 0 || (spec.band && !spec.band->contains(spec.transform, spec.n, squared)))
        continue;
      const double p = std::abs(spectrum.at(row, col)) / std::sqrt(energy);
      bits -= p > 0 ? p * std::log2(p) : 0;
      ++terms;
    }
  }
  return bits / terms;
}

/// Eq. 5-1 or 5-2 from the coefficients.
inline double moment_of(const MetricSpec& spec, const Spectrum& spectrum) {
  const bool is_fourier = family_of(spec.transform) == TransformFamily::fourier;
  const int centre = is_fourier ? spec.n / 2 : 0;
  std::uint64_t exact = 0;
  long double sum = 0;
  for (int row = 0; row < spec.n; ++row) {
    for (int col = 0; col < spec.n; ++col) {
      const double arm = std::pow(row - centre, 2) + std::pow(col - centre, 2);
      if (spec.band && !spec.band->contains(spec.transform, spec.n, arm)) continue;
      const double magnitude = std::abs(spectrum.at(row, col));
      sum += static_cast<long double>(spec.power ? magnitude * magnitude : magnitude) * arm;
      exact +=
          static_cast<std::uint64_t>(magnitude * spec.n * spec.n) * static_cast<std::uint64_t>(arm);
    }
  }
  const double n4 = std::pow(spec.n, 4);
  if (spec.is_exact()) return static_cast<double>(exact) / (n4 * spec.n * spec.n);
  return static_cast<double>(sum / n4 * (is_fourier ? 0.5 : 1));
}

}  // namespace fathom::conformance
