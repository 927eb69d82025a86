// SPDX-License-Identifier: Apache-2.0
#include "engine/spectrum_picture.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/error.hpp"

namespace fathom {
namespace {

/// Grey level of a magnitude relative to the largest one, 0 <= relative <= 1.
std::uint8_t grey(double relative, MagnitudeScale scale) {
  double level = relative;
  if (scale == MagnitudeScale::decibel) {
    level = relative > 0 ? 1 + 20 * std::log10(relative) / kSpectrumRange_dB : 0;
  }
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(level, 0.0, 1.0)));
}

/// A centred spectrum's first row and column are repeated at its end, so that zero frequency stands
/// in the middle (thesis T6).
int side_of(TransformFamily family, int n) {
  switch (family) {
    case TransformFamily::fourier:
      return n + 1;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return n;
  }
  return n;
}

}  // namespace

Frame spectrum_picture(Transform transform, int n,
                       std::span<const std::complex<double>> coefficients, MagnitudeScale scale) {
  if (n <= 0 || coefficients.size() != static_cast<std::size_t>(n) * n) {
    throw Error(ErrorCode::bad_argument, "a spectrum picture needs n * n coefficients");
  }
  std::vector<double> magnitude(coefficients.size());
  std::transform(coefficients.begin(), coefficients.end(), magnitude.begin(),
                 [](const std::complex<double>& c) { return std::abs(c); });
  const double largest = *std::max_element(magnitude.begin(), magnitude.end());
  const int side = side_of(family_of(transform), n);
  std::vector<std::uint8_t> pixels;
  pixels.reserve(static_cast<std::size_t>(side) * side);
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) {
      const double m = magnitude[static_cast<std::size_t>(row % n) * n + col % n];
      pixels.push_back(largest > 0 ? grey(m / largest, scale) : std::uint8_t{0});
    }
  }
  return Frame(side, side, std::move(pixels));
}

}  // namespace fathom
