// SPDX-License-Identifier: Apache-2.0
// The coefficients of a Fourier transform that a constant reaches through a raised cosine.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <vector>

#include "../engine/frame.hpp"
#include "../engine/metric.hpp"
#include "../engine/window.hpp"

namespace fathom {

/// Computes them without the rest of the spectrum, in double.
class LowestCoefficients {
 public:
  /// |u|, |v| <= 1.
  static constexpr int kAcross = 3, kCount = kAcross * kAcross;
  using Values = std::array<std::complex<double>, kCount>;

  /// spec: of the Fourier family; its side and taper count.
  explicit LowestCoefficients(const MetricSpec& spec);

  /// [v + 1][u + 1], scaled as Plan::spectrum. The window must lie inside of the frame.
  Values of(const Frame& frame, const Window& window);

 private:
  /// A taper, and that with one period of a cosine and of a sine, at x + 1/2, x = 0 .. n-1.
  struct Waves {
    std::vector<double> even, cosine, sine;
  };

  /// Into columns_.
  void sum_columns(const Frame& frame, const Window& window);

  int n_;
  Waves waves_;
  Waves columns_;                    ///< Sums of every column under each of them.
  std::complex<double> half_pixel_;  ///< What half a pixel turns u = 1 by.
  std::vector<std::int32_t> greys_;
};

}  // namespace fathom
