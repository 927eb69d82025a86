// SPDX-License-Identifier: Apache-2.0
// Ring powers by their definition: no table of the engine's stands behind them.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "backends/reference/formulas.hpp"

namespace fathom::reference {
namespace {

/// A ring holds what lies above its inner edge, up to and with its outer one.
struct Ring {
  double squared_inner, squared_outer;
  Real sum = 0;
  std::uint64_t exact_sum = 0;
  std::uint32_t coefficients = 0;
};

/// e(k) = (LO + (HI - LO) k / K) N, in double and in that order.
double edge(const MetricSpec& spec, int k) {
  const double low = spec.band ? spec.band->low : 0;
  const double high = spec.band ? spec.band->high : 0.5;
  return (low + (high - low) * k / spec.rings) * spec.n;
}

std::vector<Ring> rings_of(const MetricSpec& spec) {
  std::vector<Ring> rings;
  for (int k = 0; k < spec.rings; ++k) {
    const double inner = edge(spec, k), outer = edge(spec, k + 1);
    rings.push_back({inner * inner, outer * outer});
  }
  return rings;
}

/// The ring that holds a coefficient so far from zero frequency, if one does. Squares are compared:
/// those of half indices are exact.
Ring* ring_at(std::vector<Ring>& rings, double squared_radius) {
  for (Ring& ring : rings) {
    if (ring.squared_inner < squared_radius && squared_radius <= ring.squared_outer) return &ring;
  }
  return nullptr;
}

Real mass(const MetricSpec& spec, Real squared_magnitude) {
  return spec.power ? squared_magnitude : std::sqrt(squared_magnitude);
}

/// SUM w f / SUM w is subtracted before the taper, which takes F(0,0) W(u) W(v) / W(0)^2 from every
/// coefficient. Without a taper that would change F(0,0) alone, which no ring holds.
void subtract_mean(const Basis& basis, std::vector<Complex>& spectrum) {
  const int n = basis.spec.n, half = n / 2;
  const Complex zero = spectrum[static_cast<std::size_t>(half) * n + half];
  const Complex mean = zero / (basis.taper_transform[half] * basis.taper_transform[half]);
  for (int v = 0; v < n; ++v) {
    for (int u = 0; u < n; ++u) {
      spectrum[static_cast<std::size_t>(v) * n + u] -=
          mean * basis.taper_transform[v] * basis.taper_transform[u];
    }
  }
}

void add_fourier(const Basis& basis, const Frame& frame, const Window& window,
                 std::vector<Ring>& rings) {
  const MetricSpec& spec = basis.spec;
  const int half = spec.n / 2;
  auto spectrum = fourier_spectrum(basis, frame, window, Brightness::left_out);
  if (spec.taper != Taper::none()) subtract_mean(basis, spectrum);
  std::size_t place = 0;
  for (int v = -half; v < half; ++v) {
    for (int u = -half; u < half; ++u, ++place) {
      Ring* const ring = ring_at(rings, static_cast<double>(u * u + v * v));
      if (ring == nullptr) continue;
      ring->sum += mass(spec, std::norm(spectrum[place]));
      ++ring->coefficients;
    }
  }
}

/// i/2 and j/2 cycles per window.
double squared_sequency(int i, int j) { return static_cast<double>(i * i + j * j) / 4; }

/// From W or C, [i][j].
void add_real(const Basis& basis, const std::vector<Real>& spectrum, std::vector<Ring>& rings) {
  const int n = basis.spec.n;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      Ring* const ring = ring_at(rings, squared_sequency(i, j));
      if (ring == nullptr) continue;
      const Real w = spectrum[static_cast<std::size_t>(i) * n + j];
      ring->sum += mass(basis.spec, w * w);
      ++ring->coefficients;
    }
  }
}

/// From N^2 W, whole numbers.
void add_walsh(const Basis& basis, const Frame& frame, const Window& window,
               std::vector<Ring>& rings) {
  const int n = basis.spec.n;
  const Real pixels = static_cast<Real>(n) * n;
  const auto sums = walsh_sums(basis, frame, window);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      Ring* const ring = ring_at(rings, squared_sequency(i, j));
      if (ring == nullptr) continue;
      const std::int64_t sum = sums[static_cast<std::size_t>(i) * n + j];
      const Real w = static_cast<Real>(sum) / pixels;
      ring->sum += w * w;
      ring->exact_sum += static_cast<std::uint64_t>(std::abs(sum));
      ++ring->coefficients;
    }
  }
}

/// SUM N^2 |W| / (n(k) N^2), rounded once: both are whole numbers below 2^53.
double exact_mean(const MetricSpec& spec, const Ring& ring) {
  const double pixels = static_cast<double>(spec.n) * spec.n;
  return static_cast<double>(ring.exact_sum) / (ring.coefficients * pixels);
}

}  // namespace

void ring_powers(const Basis& basis, const Frame& frame, const Window& window,
                 std::span<double> values) {
  const MetricSpec& spec = basis.spec;
  std::vector<Ring> rings = rings_of(spec);
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      add_fourier(basis, frame, window, rings);
      break;
    case TransformFamily::walsh:
      if (spec.taper == Taper::none()) {
        add_walsh(basis, frame, window, rings);
      } else {
        add_real(basis, tapered_walsh_spectrum(basis, frame, window), rings);
      }
      break;
    case TransformFamily::cosine:
      add_real(basis, cosine_spectrum(basis, frame, window), rings);
      break;
  }
  std::ranges::transform(rings, values.begin(), [&](const Ring& ring) {
    return spec.is_exact() ? exact_mean(spec, ring)
                           : static_cast<double>(ring.sum / ring.coefficients);
  });
}

}  // namespace fathom::reference
