// SPDX-License-Identifier: Apache-2.0
// The formulas as direct sums, written to be read beside docs/metrics.md, not to be fast.
// Nothing here uses the engine's tables: this is the oracle that proves them.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/frame.hpp"
#include "engine/metric.hpp"
#include "engine/window.hpp"

namespace fathom::reference {

/// Sums are taken in the widest hardware type (80 bits on x86, plain double elsewhere). In double
/// the rounding of a smooth window's large low frequencies, weighted by r^2, would show in the 11th
/// digit.
using Real = long double;
using Complex = std::complex<Real>;

/// The constants of one metric: exp(-2 pi i k/N), w(x), wal_i(x) and cosines, each from its
/// definition.
struct Basis {
  explicit Basis(const MetricSpec& spec);

  MetricSpec spec;
  std::vector<Complex> root;             ///< [k] exp(-2 pi i k/N); fft only.
  std::vector<Real> taper;               ///< [x] w(x).
  std::vector<Complex> taper_transform;  ///< [u + N/2] 1/N SUM w(x) exp(-2 pi i u x/N); fft only.
  std::vector<std::int8_t> walsh;        ///< [i][x] wal_i(x) = +1 or -1; Walsh only.
  std::vector<Real> cosine;              ///< [i][x] e(i) cos(pi i (2 x + 1)/(2 N)); dct only.

 private:
  void make_fourier();
  void make_walsh();
  void make_cosine();
};

/// Whether a spectrum is that of the pixels, or of the pixels less a constant near their mean.
enum class Brightness { kept, left_out };

/// F(u,v), [v + N/2][u + N/2] (eq. 3-10).
std::vector<Complex> fourier_spectrum(const Basis& basis, const Frame& frame, const Window& window,
                                      Brightness brightness = Brightness::kept);

/// W(i,j) with a taper, [i][j].
std::vector<Real> tapered_walsh_spectrum(const Basis& basis, const Frame& frame,
                                         const Window& window);

/// N^2 W(i,j) without a taper, [i][j]: integers.
std::vector<std::int64_t> walsh_sums(const Basis& basis, const Frame& frame, const Window& window);

/// C(i,j), [i][j] (docs/metrics.md, "Cosine").
std::vector<Real> cosine_spectrum(const Basis& basis, const Frame& frame, const Window& window);

/// phi of a window (eqs. 5-1 and 5-2).
double focus_quality(const Basis& basis, const Frame& frame, const Window& window);

/// S of a window, bits per coefficient (docs/metrics.md, "Entropy").
double entropy(const Basis& basis, const Frame& frame, const Window& window);

/// Mean mass in each of spec.rings rings (docs/metrics.md, "Rings").
void ring_powers(const Basis& basis, const Frame& frame, const Window& window,
                 std::span<double> values);

}  // namespace fathom::reference
