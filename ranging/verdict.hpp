// SPDX-License-Identifier: Apache-2.0
// Whether a curve has a focus, so that noise is never sold as a distance.
#pragma once

#include <span>
#include <string>

#include "../engine/metric.hpp"
#include "search.hpp"

namespace fathom {

enum class FocusResult {
  focused,   ///< A peak that stands out of the noise, inside of what was searched.
  no_focus,  ///< Nothing that noise alone would not give (a blank card; thesis: a patch of orange).
  at_limit,  ///< The best position is the first or last searched: the focus may lie beyond.
};

/// "focused", "no-focus" or "at-limit".
const char* to_string(FocusResult result) noexcept;

/// How much the score of a featureless window scatters from frame to frame, relative to its mean,
/// when every pixel carries independent noise of one strength: a property of the metric alone,
/// whatever the strength. Follows from the weights: the moment sums N^2 magnitudes of known spread,
/// which a taper makes alike between neighbours. fft:64:hann about 0.026, walsh-sequency:64 about
/// 0.014.
double white_noise_scatter(const MetricSpec& spec);

/// What the verdict rests on.
struct Verdict {
  FocusResult result = FocusResult::no_focus;
  double contrast = 0;     ///< (best - lowest) / best, 0..1.
  double rise = 0;         ///< (best - lowest) in units of the noise at the lowest score.
  double needed_rise = 0;  ///< What noise alone would not reach in as many evaluations.
  std::string reason;      ///< One line for the user.
};

/// Judges the curve that a search has left.
/// repeat_scatter: relative scatter of the score measured by taking one position several times, or
/// 0 where that cannot be measured (a replayed stack repeats exactly).
Verdict judge(std::span<const Evaluation> evaluations, const MetricSpec& spec,
              double repeat_scatter);

}  // namespace fathom
