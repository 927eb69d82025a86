// SPDX-License-Identifier: Apache-2.0
#include "focus/noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "engine/quantile.hpp"
#include "engine/tables.hpp"
#include "engine/window.hpp"

namespace fathom {
namespace {

/// Relative spread (standard deviation over mean) of one coefficient's mass under Gaussian noise:
/// |F| is Rayleigh, |F|^2 exponential, |W| and |C| half-normal, their squares chi-squared with one
/// degree of freedom.
double mass_spread(const MetricSpec& spec) {
  constexpr double pi = std::numbers::pi;
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      return spec.power ? 1.0 : std::sqrt(4 / pi - 1);
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return spec.power ? std::sqrt(2.0) : std::sqrt(pi / 2 - 1);
  }
  return 0;
}

/// How many coefficients of a real picture say the same: the Fourier transform's come in conjugate
/// pairs, so only half are independent.
double copies_of(TransformFamily family) {
  switch (family) {
    case TransformFamily::fourier:
      return 2;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return 1;
  }
  return 1;
}

/// How much each coefficient's mass counts in a score of noise. An entropy's terms p log2(1/p) grow
/// nearly as p does, where p is small: the logarithm hardly changes.
std::vector<double> weights_of(const MetricSpec& spec) {
  switch (spec.measure) {
    case Measure::moment:
    case Measure::rings:
      return tables::moment_weights(spec);
    case Measure::entropy:
      return tables::entropy_weights(spec);
  }
  return {};
}

/// How many coefficients one taper makes into one, along one axis: SUM w^4 N / (SUM w^2)^2.
double taper_correlation(const MetricSpec& spec) {
  double squares = 0, fourths = 0;
  for (const double w : tables::taper(spec.taper, spec.n)) {
    squares += w * w;
    fourths += w * w * w * w;
  }
  return fourths * spec.n / (squares * squares);
}

/// Noise of one score from how far scores lie from the line between their neighbours, by the
/// median, which the few points of a narrow peak hardly move: right where a curve was sampled
/// densely, much too large where it was not.
double neighbour_noise(std::span<const Evaluation> curve) {
  if (curve.size() < kDense) return std::numeric_limits<double>::infinity();
  std::vector<double> bends;
  for (std::size_t i = 1; i + 1 < curve.size(); ++i) {
    const Evaluation &left = curve[i - 1], &right = curve[i + 1];
    const double span = right.position - left.position;
    const double part = span > 0 ? (curve[i].position - left.position) / span : 0.5;
    const double line = left.score + part * (right.score - left.score);
    const double variances = 1 + part * part + (1 - part) * (1 - part);
    bends.push_back(std::abs(curve[i].score - line) / std::sqrt(variances));
  }
  constexpr double kMedianOfGaussian = 0.6745;  // median of |x| for sigma 1
  const double sigma = quantile(bends, 0.5) / kMedianOfGaussian;
  // A median of few bends is itself uncertain by some 1.2 / sqrt(n): take the upper end, two of
  // those.
  return sigma * (1 + 2.4 / std::sqrt(static_cast<double>(bends.size())));
}

}  // namespace

double white_noise_scatter(const MetricSpec& spec) {
  double sum = 0, squares = 0;
  for (const double weight : weights_of(spec)) {
    sum += weight;
    squares += weight * weight;
  }
  if (sum == 0) return 1;  // an empty band: nothing to tell apart
  const double copies = copies_of(family_of(spec.transform));
  // The variance grows by the correlation of each axis, the scatter by the root of their product.
  return mass_spread(spec) * std::sqrt(squares * copies) / sum * taper_correlation(spec);
}

double white_noise_score(const MetricSpec& spec) {
  if (spec.measure == Measure::entropy) return 0;  // it depends on the light that the noise is in
  double weights = 0, squares = 0;
  for (const double weight : tables::moment_weights(spec)) weights += weight;
  for (const double w : tables::taper(spec.taper, spec.n)) squares += w * w;
  // |F|^2 is exponential, |W|^2 and |C|^2 are chi-squared, of this mean.
  const double power = squares * squares / std::pow(spec.n, 4);
  constexpr double pi = std::numbers::pi;
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      return weights / (2 * std::pow(spec.n, 4)) * (spec.power ? power : std::sqrt(power * pi) / 2);
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return weights / std::pow(spec.n, 4) * (spec.power ? power : std::sqrt(power * 2 / pi));
  }
  return 0;
}

namespace {

/// The part of a floor that noise makes, 0..1; the rest is texture, which does not scatter. 1 where
/// nobody knows.
double noisy_part(double floor, const std::vector<Evaluation>& curve, const Scatter& scatter) {
  constexpr double kSafety = 2;  // noise that neighbours share, as in JPEG, looks like less
  const double noise = score_of_noise(curve, scatter.light.white_score, scatter.light.exponent);
  return noise > 0 && floor > 0 ? std::min(1.0, kSafety * noise / floor) : 1;
}

/// Quantile, relative to the mean, of a score that noise alone gives: a sum of squares or
/// magnitudes, so close to a gamma distribution of relative scatter `scatter` (Wilson & Hilferty
/// 1931). z: of the normal distribution. With few coefficients its tail is long, where a Gaussian's
/// would promise too much.
double noise_quantile(double scatter, double z) {
  const double root = 1 - scatter * scatter / 9 + z * scatter / 3;
  return root > 0 ? root * root * root : 0;
}

/// Best over the lowest fifth that noise alone does not reach in n scores. The highest of n stands
/// some sqrt(2 ln n) above the mean; three more sigmas make it safe. A fifth of n scores is itself
/// uncertain by 1.43 / sqrt(n). A handful of coefficients scatters too wildly to be judged by at
/// all.
double needed_ratio(double scatter, std::size_t count) {
  constexpr double kTooWild = 0.5;
  if (scatter > kTooWild) return std::numeric_limits<double>::infinity();
  const double n = static_cast<double>(count);
  const double highest = noise_quantile(scatter, 3 + std::sqrt(2 * std::log(n)));
  const double fifth = noise_quantile(scatter, -0.842 - 2 * 1.43 / std::sqrt(n));
  return fifth > 0 ? highest / fifth : std::numeric_limits<double>::infinity();
}

/// Scores in the order of their positions, each the mean of `width` that follow each other.
std::vector<double> running_means(std::span<const Evaluation> curve, std::size_t width) {
  std::vector<double> means;
  for (std::size_t i = 0; i + width <= curve.size(); ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < width; ++k) sum += curve[i + k].score;
    means.push_back(sum / static_cast<double>(width));
  }
  return means;
}

/// Relative scatter of a score far from focus.
double scatter_at(double floor, const std::vector<Evaluation>& curve, const Scatter& scatter) {
  const double neighbours = neighbour_noise(curve) / floor;
  const double white = scatter.white * noisy_part(floor, curve, scatter);
  return std::max({scatter.repeat, std::min(white, neighbours), 1e-6});
}

/// rise and needed of scores that scatter by `scatter`, of which `count` are independent.
void compare(const std::vector<double>& scores, double scatter, std::size_t count, Rise& rise) {
  const double floor = quantile(scores, 0.2);  // the lowest itself is low by chance
  const double best = *std::max_element(scores.begin(), scores.end());
  const double found = std::min((best / floor - 1) / scatter, kBoundless);
  const double needed = std::min((needed_ratio(scatter, count) - 1) / scatter, kBoundless);
  if (rise.needed > 0 && found / needed <= rise.rise / rise.needed) return;
  rise.rise = found;
  rise.needed = needed;
}

}  // namespace

bool Rise::stands_out() const { return is_beyond_noise() && contrast > kLeastContrast; }

Scatter Scatter::of_parts() const {
  MetricSpec half = spec;
  half.n = std::max(spec.n / 2, kSmallestWindow);
  return {half, 0};
}

double relative_scatter(std::span<const double> scores) {
  const auto count = static_cast<double>(scores.size());
  double mean = 0, squares = 0;
  for (const double score : scores) mean += score / count;
  for (const double score : scores) squares += (score - mean) * (score - mean);
  return scores.size() < 2 || mean == 0 ? 0 : std::sqrt(squares / (count - 1)) / mean;
}

ScoreNoise noise_of(double repeat_scatter, double floor) {
  if (!(repeat_scatter > 0 && floor > 0)) return {};
  return {repeat_scatter * floor, kRepeatFrames - 1};
}

ScoreNoise noise_of(const Scatter& scatter, const FocusCurve& curve) {
  constexpr double kFreedom = 10;  // a guess, but a good one
  const ScoreNoise repeated = noise_of(scatter.repeat, curve.floor());
  const double shown =
      scatter.white *
      score_of_noise(curve.evaluations(), scatter.light.white_score, scatter.light.exponent);
  if (!(shown > 0)) return repeated;
  // Each by what it is worth.
  const double freedom = repeated.freedom + kFreedom;
  const double squares =
      repeated.freedom * repeated.sigma * repeated.sigma + kFreedom * shown * shown;
  return {std::sqrt(squares / freedom), freedom};
}

double noise_of_lobes(const FocusCurve& curve, const Scatter& scatter) {
  constexpr double kSigmas = 3;
  const double best = curve.top().score;
  return std::max(kSigmas * scatter_at(best, curve.evaluations(), scatter) * best, 1e-300);
}

Rise rise_of(const FocusCurve& curve, const Scatter& scatter) {
  const std::vector<Evaluation>& live = curve.live();
  Rise rise;
  if (live.size() < kFewestLive) return rise;
  const double best = curve.top().score;
  double lowest = best;
  for (const Evaluation& e : live) lowest = std::min(lowest, e.score);
  rise.contrast = (best - lowest) / best;
  const double one = scatter_at(curve.floor(), live, scatter);  // of a single score
  for (const std::size_t width : {1, 3, 5}) {
    if (width > 1 && live.size() < kDense) break;
    const auto wide = static_cast<double>(width);
    compare(running_means(live, width), one / std::sqrt(wide), live.size() / width, rise);
  }
  return rise;
}

}  // namespace fathom
