// SPDX-License-Identifier: Apache-2.0
#include "focus/light.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom {
namespace {

/// A picture that changes by more has no lamp to be taken out: bright things enter or leave it.
constexpr double kMost = 1.4;

/// lamp_ratio() of each evaluation to the first.
std::vector<double> lights_of(const std::vector<Evaluation>& evaluations) {
  std::vector<double> lights;
  const double first = evaluations.empty() ? 0 : evaluations.front().picture.light;
  for (const Evaluation& e : evaluations) {
    lights.push_back(lamp_ratio(e.picture.light, first));
  }
  return lights;
}

std::vector<Evaluation> divided(std::vector<Evaluation> evaluations, double exponent,
                                double floor) {
  const std::vector<double> lights = lights_of(evaluations);
  for (std::size_t i = 0; i < evaluations.size(); ++i) {
    double& score = evaluations[i].score;
    if (score > floor) score = floor + (score - floor) / std::pow(lights[i], exponent);
  }
  return evaluations;
}

}  // namespace

double lamp_ratio(double now, double first) {
  return first > 0 && now > 0 ? std::clamp(now / first, 1 / kMost, kMost) : 1;
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

std::vector<Evaluation> in_one_light(std::vector<Evaluation> evaluations,
                                     const LightResponse& response) {
  if (response.exponent == 0) return evaluations;
  const double noise = score_of_noise(evaluations, response.white_score, response.exponent);
  return divided(std::move(evaluations), response.exponent, noise);
}

FocusCurve wholly_in_one_light(const FocusCurve& curve, double exponent) {
  return FocusCurve(divided(curve.evaluations(), exponent, 0));
}

}  // namespace fathom
