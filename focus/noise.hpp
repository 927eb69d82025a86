// SPDX-License-Identifier: Apache-2.0
// What noise alone does to a focus curve, so that it is never sold as a focus.
#pragma once

#include <span>
#include <vector>

#include "../engine/metric.hpp"
#include "curve.hpp"
#include "light.hpp"
#include "peak.hpp"

namespace fathom {

/// Frames scored at the first position to learn how far the score repeats (thesis T12).
inline constexpr int kRepeatFrames = 5;

/// How much the score of a featureless window scatters from frame to frame, relative to its mean,
/// when every pixel carries independent noise of one strength: a property of the metric alone,
/// whatever the strength. Follows from the weights: the moment sums N^2 magnitudes of known spread,
/// which a taper makes alike between neighbours. fft:64:hann about 0.026, walsh-sequency:64 about
/// 0.014.
double white_noise_scatter(const MetricSpec& spec);

/// The mean score of a featureless window whose pixels carry independent noise of deviation 1; that
/// of deviation s is s to the light_exponent() times as much. Follows from the weights, too. 0 for an
/// entropy, of which nobody can say so: it follows noise over light.
double white_noise_score(const MetricSpec& spec);

/// How far scores scatter, relative to themselves.
struct Scatter {
  /// repeat: measured by taking one position kRepeatFrames times, or 0 where that cannot be
  /// measured (a replayed stack repeats exactly).
  Scatter(const MetricSpec& its_spec, double repeat_scatter)
      : spec(its_spec),
        white(white_noise_scatter(spec)),
        repeat(repeat_scatter),
        light{light_exponent(spec), white_noise_score(spec)} {}

  /// That of a window's parts, which nobody has repeated.
  Scatter of_parts() const;

  MetricSpec spec;

  double white;  ///< What the metric makes of noise alone.
  double repeat;
  LightResponse light;
};

/// Standard deviation of repeated scores over their mean (T12); 0 for fewer than two, or about 0.
double relative_scatter(std::span<const double> scores);

/// Light that drifts by a few percent makes scores rise by as much.
inline constexpr double kLeastContrast = 0.04;

/// How far the best score stands above the rest of a curve.
struct Rise {
  double contrast = 0;  ///< (best - lowest) / best, 0..1.
  double rise = 0;      ///< (best - floor) in units of the noise at the floor.
  double needed = 0;    ///< What noise alone would not reach in as many evaluations.

  /// Whether this is more than noise would give.
  bool is_beyond_noise() const { return rise > needed; }
  /// And than a lamp that drifts would.
  bool stands_out() const;
};

/// What stands for a rise without bound.
inline constexpr double kBoundless = 1e6;

/// Of dense curves running means of 3 and 5 are looked at as well: a broad hill stands out of noise
/// that each of its scores drowns in.
Rise rise_of(const FocusCurve& curve, const Scatter& scatter);

/// The repeatability measured far from focus, where scores are `floor`, as a fit takes it.
ScoreNoise noise_of(double repeat_scatter, double floor);

/// The same, and what the noise that the pictures show makes of the metric, each by what it is worth.
ScoreNoise noise_of(const Scatter& scatter, const FocusCurve& curve);

/// A dip that is not noise, in units of the score: three times the noise of the best score. Never
/// 0.
double noise_of_lobes(const FocusCurve& curve, const Scatter& scatter);

}  // namespace fathom
