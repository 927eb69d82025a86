// SPDX-License-Identifier: Apache-2.0
// A spectrum made fit to look at (thesis T6).
#pragma once

#include <complex>
#include <span>

#include "frame.hpp"
#include "metric.hpp"

namespace fathom {

enum class MagnitudeScale { linear, decibel };

/// Spread of the dB picture: this far below the largest magnitude is black.
inline constexpr double kSpectrumRange_dB = 80;

/// An 8-bit picture of the magnitudes of `coefficients` as Plan::spectrum gives them. fft: row 0
/// and column 0 repeated as row N and column N so that the picture is symmetric, (N+1) x (N+1);
/// Walsh: N x N. linear: 0 to the largest magnitude becomes 0 to 255; decibel: kSpectrumRange_dB up
/// to the largest. An all-zero spectrum is black. Throws Error(bad_argument) unless there are n * n
/// coefficients.
Frame spectrum_picture(Transform transform, int n,
                       std::span<const std::complex<double>> coefficients, MagnitudeScale scale);

}  // namespace fathom
