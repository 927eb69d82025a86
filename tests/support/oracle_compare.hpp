// SPDX-License-Identifier: Apache-2.0
// Comparisons of scores and spectra with an oracle, in which a NaN never passes, and the tolerances
// that the project owes (docs/metrics.md, "How exact the scores are").
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <span>

#include "engine/metric.hpp"

namespace fathom::test {

/// Largest relative error of a score that a backend may have; 0 means equal to the last bit.
inline double score_tolerance(const MetricSpec& spec) {
  if (spec.is_exact()) return 0;
  return spec.n <= 128 ? 2e-6 : 5e-6;
}

/// Equal to the last bit, and a number.
inline ::testing::AssertionResult bit_equal(double got, double expected) {
  if (std::isfinite(got) &&
      std::bit_cast<std::uint64_t>(got) == std::bit_cast<std::uint64_t>(expected)) {
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << std::hexfloat << got << " is not " << expected << " ("
                                       << std::defaultfloat << got << ", " << expected << ")";
}

/// |got - expected| <= bound, all three finite.
inline ::testing::AssertionResult within(double got, double expected, double bound) {
  // Every comparison with NaN is false, so only a number that is near enough gets through.
  if (std::isfinite(got) && std::isfinite(expected) && std::abs(got - expected) <= bound) {
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << got << " differs from " << expected << " by "
                                       << got - expected << ", allowed " << bound;
}

/// An entropy of a pixel one grey level darker than its neighbours, all as bright as can be:
/// coefficients of 1/(N 65535) of the norm.
inline double entropy_of_one_grey_level(const MetricSpec& spec) {
  const double p = 1 / (65535.0 * spec.n);
  return p * std::log2(1 / p);
}

/// What a single pixel, one grey level brighter than its black neighbours, scores without a taper
/// (eqs. 5-1, 5-2 with every |F| = 1/N^2): the least that a picture can differ from a flat one.
inline double one_grey_level(const MetricSpec& spec) {
  if (spec.measure == Measure::entropy) return entropy_of_one_grey_level(spec);
  const bool fft = family_of(spec.transform) == TransformFamily::fourier;
  const int first = fft ? -spec.n / 2 : 0;
  double arms = 0;
  for (int v = first; v < first + spec.n; ++v) {
    for (int u = first; u < first + spec.n; ++u) {
      const double squared = double(v) * v + double(u) * u;
      if (!spec.band || spec.band->contains(spec.transform, spec.n, squared)) arms += squared;
    }
  }
  const double mass = std::pow(spec.n, spec.power ? -4 : -2);
  return arms * mass * (fft ? 0.5 : 1) * std::pow(spec.n, -4);
}

/// A score that is to be met, and what an error of it is relative to. Where the true score is zero
/// (a flat window under a band that leaves out its only coefficients), no relative error exists:
/// then it is relative to one_grey_level().
struct Target {
  double score;
  double scale;

  /// grey_level: one_grey_level() of the metric; least_scale: what the error is relative to where
  /// the score is smaller than that.
  Target(double expected, double grey_level, double least_scale) {
    // 1e-10 is far above what rounding leaves of a zero in the oracle (1e-16 of a grey level and
    // less) and far below the least score of a picture that is not flat.
    const bool vanishes = std::abs(expected) < 1e-10 * grey_level;
    score = vanishes ? 0 : expected;
    scale = std::max(vanishes ? grey_level : std::abs(expected), least_scale);
  }
};

/// Whether a backend's score is the oracle's, to the relative tolerance; 0 asks for the last bit.
/// least_scale: what the error is relative to where the score is smaller than that.
inline ::testing::AssertionResult score_matches(double got, double expected, const MetricSpec& spec,
                                                double tolerance, double least_scale = 0) {
  if (tolerance == 0) return bit_equal(got, expected);
  const Target target(expected, one_grey_level(spec), least_scale);
  return within(got, target.score, tolerance * target.scale);
}

/// A band may leave out nearly all that a picture holds, as the low ones do with a checkerboard.
/// Rounding follows what the picture holds, so a band with less than a fiftieth of the whole moment
/// is judged against that fiftieth: this is it, score_matches' least_scale. oracle_score: the
/// oracle's score of the same picture for another metric.
template <class OracleScore>
double least_scale(const MetricSpec& spec, OracleScore&& oracle_score) {
  if (!spec.band) return 0;
  MetricSpec whole = spec;
  whole.band.reset();
  return oracle_score(whole) / 50;
}

/// What quantisation to whole grey levels leaves in a coefficient's mass: white noise of variance
/// 1/12 under the taper w, SUM w^2 / (12 N^4), and its root for magnitudes.
inline double quantisation(const MetricSpec& spec) {
  double squares = 0;  // of one axis
  for (int x = 0; x < spec.n; ++x) {
    const double flank = spec.taper.cosine_fraction * spec.n / 2;
    const double distance = std::min(x, spec.n - 1 - x) + 0.5;
    const double w = distance < flank ? (1 - std::cos(std::numbers::pi * distance / flank)) / 2 : 1;
    squares += w * w;
  }
  const double power = squares * squares / (12 * std::pow(spec.n, 4));
  return spec.power ? power : std::sqrt(power);
}

/// Largest error of a ring's value, in parts of the value and quantisation().
inline constexpr double kRingTolerance = 1e-5;

/// Whether one of a metric's values is the oracle's: of rings that are no exact sums, to
/// `tolerance` of the value and quantisation(); `grain`: that of the metric.
inline ::testing::AssertionResult ring_matches(double got, double expected, const MetricSpec& spec,
                                               double grain, double tolerance = kRingTolerance) {
  if (spec.is_exact()) return bit_equal(got, expected);
  return within(got, expected, tolerance * (expected + grain));
}

/// Whether two spectra agree: ||got - expected|| <= tolerance ||expected||, and no coefficient is
/// NaN. least_norm: what the error is relative to where the spectrum is smaller than that.
inline ::testing::AssertionResult spectrum_matches(std::span<const std::complex<double>> got,
                                                   std::span<const std::complex<double>> expected,
                                                   double tolerance, double least_norm = 0) {
  if (got.size() != expected.size()) return ::testing::AssertionFailure() << "sizes differ";
  double error = 0, mass = 0;
  for (std::size_t k = 0; k < got.size(); ++k) {
    error += std::norm(got[k] - expected[k]);
    mass += std::norm(expected[k]);
  }
  return within(std::sqrt(error), 0, tolerance * std::max(std::sqrt(mass), least_norm))
         << " (norm of the difference)";
}

}  // namespace fathom::test
