// SPDX-License-Identifier: Apache-2.0
// Tables that fast backends are built from: computed once per plan, always in double.
// The `reference` backend uses none of them, so that it can prove them right.
#pragma once

#include <complex>
#include <vector>

#include "metric.hpp"

namespace fathom::tables {

/// w(x), x = 0 .. n-1: raised cosine over the outer fraction of the axis, hann for fraction 1:
/// 1/2 (1 - cos(2 pi (x + 1/2)/n)) (thesis T3).
std::vector<double> taper(Taper taper, int n);

/// The taper's own transform W(u) = 1/n SUM w(x) exp(-2 pi i u x/n), u = 0 .. n-1 in DFT order.
/// A constant m under the taper adds m W(u) W(v) to the spectrum: subtract m from the pixels, add
/// that back, and the rounding noise of a large mean is gone. Hann: only u = 0, 1, n-1 are not
/// zero.
std::vector<std::complex<double>> taper_spectrum(Taper taper, int n);

/// exp(-2 pi i k/n), k = 0 .. n-1; exact on the axes and symmetric between octants.
std::vector<std::complex<double>> twiddles(int n);

/// For coefficient i of a Walsh order, its index in Paley (dyadic) order, which a fast transform
/// with bit-reversed input gives: the Gray code of i for sequency, the bit reversal of i for
/// Hadamard (thesis T5). Throws Error(bad_argument) for fft and dct.
std::vector<int> paley_index(Transform walsh, int n);

/// Squared lever arm along one axis of the coefficient stored at k: u^2 with u = k or k - n for fft
/// in DFT order, i^2 for Walsh in its own order and for dct (eqs. 5-1, 5-2). Both axes use the same table.
std::vector<double> lever_arms(Transform transform, int n);

/// Squared lever arm of every coefficient, zero outside the band: [row][col], stored as lever_arms.
std::vector<double> moment_weights(const MetricSpec& spec);

/// 1 for every coefficient that an entropy has a term of, 0 for zero frequency and outside the
/// band: [row][col], stored as lever_arms.
std::vector<double> entropy_weights(const MetricSpec& spec);

/// What the fast kernels compute are whole multiples: 2 N^2 F, N^2 W and N^2 C (eq. 3-10). The factor back
/// to a coefficient, a power of two.
constexpr double coefficient_scale(Transform transform, int n) {
  switch (family_of(transform)) {
    case TransformFamily::fourier:
      return 1 / (2.0 * n * n);
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return 1 / (1.0 * n * n);
  }
  return 0;
}

/// The factor from SUM |2 N^2 F| r^2 over half of the plane, or SUM |N^2 W| r^2 (SUM |N^2 C| r^2)
/// over all of it, to the score (eqs. 5-1, 5-2); with `power` from the squares. A power of two.
constexpr double moment_scale(const MetricSpec& spec) {
  const double n = spec.n, coefficient = coefficient_scale(spec.transform, spec.n);
  return (spec.power ? coefficient * coefficient : coefficient) / (n * n * n * n);
}

/// Noise that a transform in single precision leaves in N^2 F, relative to the root of SUM (w w (f
/// - g))^2, and the relative error of a score that it is trusted with (docs/metrics.md, "When float
/// is not enough").
inline constexpr double kFloatNoise = 2 * 0x1p-24, kFloatTolerance = 2e-6;

/// The least score that a transform in float is trusted with per unit of contrast, the root of SUM
/// (w(x) w(y) (f(x,y) - brightness))^2; with `power` per its square. Below it the noise of rounding
/// scores more than the tolerance (docs/metrics.md, "When float is not enough"). fft only.
double least_trusted(const MetricSpec& spec);

}  // namespace fathom::tables
