// SPDX-License-Identifier: Apache-2.0
#include "ranging/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "engine/tables.hpp"

namespace fathom {
namespace {

/// Relative spread (standard deviation over mean) of one coefficient's mass under Gaussian noise:
/// |F| is Rayleigh, |F|^2 exponential, |W| half-normal, |W|^2 chi-squared with one degree of
/// freedom.
double mass_spread(const MetricSpec& spec) {
  constexpr double pi = std::numbers::pi;
  if (is_walsh(spec.transform)) return spec.power ? std::sqrt(2.0) : std::sqrt(pi / 2 - 1);
  return spec.power ? 1.0 : std::sqrt(4 / pi - 1);
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

/// The element that `part` (0..1) of the values lie below.
double quantile(std::vector<double> values, double part) {
  const auto at = static_cast<std::size_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[at];
}

/// Noise of one score from the median step between neighbours by position, which the few steps of a
/// peak hardly move: right where a curve was sampled densely, much too large where it was not.
double neighbour_noise(std::vector<Evaluation> curve) {
  constexpr std::size_t kFewest = 30;  // fewer say too little
  if (curve.size() < kFewest) return std::numeric_limits<double>::infinity();
  std::sort(curve.begin(), curve.end(),
            [](const Evaluation& a, const Evaluation& b) { return a.position < b.position; });
  std::vector<double> steps;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    steps.push_back(std::abs(curve[i].score - curve[i - 1].score));
  }
  constexpr double kMedianOfGaussian = 0.6745;  // median of |x| for sigma 1
  const double sigma = quantile(steps, 0.5) / (kMedianOfGaussian * std::numbers::sqrt2);
  // A median of few steps is itself uncertain by some 1.2 / sqrt(n): take the upper end, two of
  // those.
  return sigma * (1 + 2.4 / std::sqrt(static_cast<double>(steps.size())));
}

bool is_outermost(const Evaluation& best, std::span<const Evaluation> evaluations) {
  const auto [first, last] = std::minmax_element(
      evaluations.begin(), evaluations.end(),
      [](const Evaluation& a, const Evaluation& b) { return a.position < b.position; });
  return best.position == first->position || best.position == last->position;
}

constexpr double kFar = 1e6;  // stands for a rise without bound

std::string reason(const Verdict& verdict, const Evaluation& best) {
  switch (verdict.result) {
    case FocusResult::focused:
      return fmt::format("the peak at {:g} stands {:.0f} times the noise above the floor",
                         best.position, verdict.rise);
    case FocusResult::no_focus:
      if (verdict.needed_rise >= kFar) {
        return "so few coefficients scatter too much to judge a focus by; use a larger window or "
               "a wider band";
      }
      return fmt::format(
          "the scores rise by {:.1f} times the noise, and noise alone may give {:.1f}; try more "
          "light, or a larger window on more edges",
          verdict.rise, verdict.needed_rise);
    case FocusResult::at_limit:
      return fmt::format(
          "the best score is at {:g}, an end of what was searched; the focus may lie "
          "beyond it, try a wider --from, --to or --bracket",
          best.position);
  }
  return {};
}

}  // namespace

const char* to_string(FocusResult result) noexcept {
  switch (result) {
    case FocusResult::focused:
      return "focused";
    case FocusResult::no_focus:
      return "no-focus";
    case FocusResult::at_limit:
      return "at-limit";
  }
  return "unknown";
}

double white_noise_scatter(const MetricSpec& spec) {
  double sum = 0, squares = 0;
  for (const double weight : tables::moment_weights(spec)) {
    sum += weight;
    squares += weight * weight;
  }
  if (sum == 0) return 1;  // an empty band: nothing to tell apart
  // A real picture's Fourier coefficients come in conjugate pairs, so only half are independent.
  const double copies = is_walsh(spec.transform) ? 1 : 2;
  // The variance grows by the correlation of each axis, the scatter by the root of their product.
  return mass_spread(spec) * std::sqrt(squares * copies) / sum * taper_correlation(spec);
}

namespace {

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

}  // namespace

Verdict judge(std::span<const Evaluation> evaluations, const MetricSpec& spec,
              double repeat_scatter) {
  const Evaluation& best = best_of(evaluations);
  std::vector<double> scores;
  for (const Evaluation& e : evaluations) scores.push_back(e.score);
  const double lowest = *std::min_element(scores.begin(), scores.end());
  const double floor = quantile(scores, 0.2);  // the lowest itself is low by chance
  constexpr double kLeastContrast = 0.04;      // light that drifts by a few percent does as much
  Verdict verdict;
  verdict.contrast = best.score > 0 ? (best.score - lowest) / best.score : 0;
  if (floor > 0) {
    const double neighbours = neighbour_noise({evaluations.begin(), evaluations.end()}) / floor;
    const double scatter =
        std::max({repeat_scatter, std::min(white_noise_scatter(spec), neighbours), 1e-6});
    verdict.rise = std::min((best.score / floor - 1) / scatter, kFar);
    verdict.needed_rise = std::min((needed_ratio(scatter, evaluations.size()) - 1) / scatter, kFar);
  } else {
    verdict.rise = best.score > 0 ? kFar : 0;
  }
  const bool stands_out = verdict.rise > verdict.needed_rise && verdict.contrast > kLeastContrast;
  verdict.result = !stands_out                       ? FocusResult::no_focus
                   : is_outermost(best, evaluations) ? FocusResult::at_limit
                                                     : FocusResult::focused;
  verdict.reason = reason(verdict, best);
  return verdict;
}

}  // namespace fathom
