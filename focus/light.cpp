// SPDX-License-Identifier: Apache-2.0
#include "focus/light.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom {
namespace {

/// A picture that changes by more has no lamp to be taken out: bright things enter or leave it.
constexpr double kMost = 1.4;

/// 1 where one of them is not known.
double light_ratio(double now, double first) { return first > 0 && now > 0 ? now / first : 1; }

using Ratio = double (*)(double now, double first);

/// The ratio of each evaluation's light to the first's.
std::vector<double> lights_of(const std::vector<Evaluation>& evaluations, Ratio ratio) {
  std::vector<double> lights;
  const double first = evaluations.empty() ? 0 : evaluations.front().picture.light;
  for (const Evaluation& e : evaluations) lights.push_back(ratio(e.picture.light, first));
  return lights;
}

std::vector<Evaluation> divided(std::vector<Evaluation> evaluations, double exponent, double floor,
                                Ratio ratio) {
  const std::vector<double> lights = lights_of(evaluations, ratio);
  for (std::size_t i = 0; i < evaluations.size(); ++i) {
    double& score = evaluations[i].score;
    if (score > floor) score = floor + (score - floor) / std::pow(lights[i], exponent);
  }
  return evaluations;
}

}  // namespace

double lamp_ratio(double now, double first) {
  return std::clamp(light_ratio(now, first), 1 / kMost, kMost);
}

double light_exponent(const MetricSpec& spec) {
  switch (spec.measure) {
    case Measure::moment:
    case Measure::rings:
      return spec.power ? 2 : 1;
    case Measure::entropy:
      return 0;
  }
  return 0;
}

double score_of_noise(const std::vector<Evaluation>& evaluations, double white_score,
                      double exponent) {
  double least = std::numeric_limits<double>::infinity();
  for (const Evaluation& e : evaluations) least = std::min(least, e.picture.noise);
  if (!(least > 0 && std::isfinite(least))) return 0;
  return std::min(white_score * std::pow(least, exponent), FocusCurve(evaluations).floor());
}

namespace {

std::vector<Evaluation> levelled(std::vector<Evaluation> evaluations, const LightResponse& response,
                                 Ratio ratio) {
  if (response.exponent == 0) return evaluations;
  const double noise = score_of_noise(evaluations, response.white_score, response.exponent);
  return divided(std::move(evaluations), response.exponent, noise, ratio);
}

}  // namespace

std::vector<Evaluation> in_one_light(std::vector<Evaluation> evaluations,
                                     const LightResponse& response) {
  return levelled(std::move(evaluations), response, lamp_ratio);
}

std::vector<Evaluation> in_one_exposure(std::vector<Evaluation> evaluations,
                                        const LightResponse& response) {
  return levelled(std::move(evaluations), response, light_ratio);
}

bool is_beyond_a_lamp(const std::vector<Evaluation>& evaluations) {
  return lights_of(evaluations, light_ratio) != lights_of(evaluations, lamp_ratio);
}

FocusCurve wholly_in_one_light(const FocusCurve& curve, double exponent) {
  return FocusCurve(divided(curve.evaluations(), exponent, 0, lamp_ratio));
}

}  // namespace fathom
