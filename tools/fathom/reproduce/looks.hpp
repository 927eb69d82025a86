// SPDX-License-Identifier: Apache-2.0
// What the camera sees and what the score makes of it: targets, spectra, and where in them the score lies.
#pragma once

#include <complex>
#include <vector>

#include "engine/frame.hpp"
#include "tools/fathom/reproduce/measuring.hpp"

namespace fathom::reproduce {

/// The same for every target, so that blur is the same: its distance, and how far from focus "blurred" is.
inline constexpr double kLookDistance = 1800;
inline constexpr double kBlurSteps = 60;
inline constexpr const char* kTargets[] = {"usaf", "seedling", "orange"};
inline constexpr std::size_t kChart = 0;
/// The transforms whose spectra are shown: both have an order of frequency.
inline constexpr std::size_t kShown[] = {kFft, kSequency};
/// Bands of the sums, each 0.5 / kBands cycles per pixel wide; one more has what lies beyond 0.5, in the corners.
inline constexpr int kBands = 32;

/// The spectrum of the window, and the score as the sum of its bands.
struct SpectrumLook {
  std::size_t transform = kFft;
  std::vector<std::complex<double>> coefficients;
  double score = 0;           ///< As every other score of the report is computed.
  std::vector<double> bands;  ///< [kBands + 1], what each adds to the score.

  /// Sum of the bands from one frequency to another, cycles per pixel, multiples of 0.5 / kBands.
  double between(double low, double high) const;
};

struct Look {
  std::size_t target = kChart;
  bool sharp = true;
  double position = 0;
  Frame frame;
  Window window;
  std::vector<SpectrumLook> spectra;  ///< One of each of kShown; of the chart alone.
};

struct Looks {
  std::vector<Look> looks;

  const Look& find(std::size_t target, bool sharp) const;
};

/// Adds what must be measured; `looks` must stay where it is until that is done.
void plan_looks(Looks& looks, const ShouldStop& should_stop, Tasks& tasks);

}  // namespace fathom::reproduce
