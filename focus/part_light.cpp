// SPDX-License-Identifier: Apache-2.0
#include "focus/part_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fathom {
namespace {

bool is_known(const Evaluation& e) {
  const auto above_0 = [](double value) { return value > 0; };
  const PictureFacts& picture = e.picture;
  return picture.light > 0 && std::all_of(picture.parts.begin(), picture.parts.end(), above_0) &&
         std::all_of(picture.part_brightness.begin(), picture.part_brightness.end(), above_0);
}

std::array<double, kParts> mean_brightness(const std::vector<Evaluation>& evaluations) {
  std::array<double, kParts> mean{};
  for (const Evaluation& e : evaluations) {
    for (std::size_t i = 0; i < kParts; ++i)
      mean[i] += e.picture.part_brightness[i] / static_cast<double>(evaluations.size());
  }
  return mean;
}

/// The sum of the parts' scores. light(picture, part): what each is divided by.
template <class Light>
FocusCurve sum_of_parts(std::vector<Evaluation> evaluations, Light light) {
  for (Evaluation& e : evaluations) {
    e.score = 0;
    for (std::size_t i = 0; i < kParts; ++i) e.score += e.picture.parts[i] / light(e.picture, i);
  }
  return FocusCurve(std::move(evaluations));
}

/// Of all parts, in the light of the whole picture.
FocusCurve in_common_light(const std::vector<Evaluation>& evaluations, double exponent) {
  const double first = evaluations.front().picture.light;
  return sum_of_parts(evaluations, [&](const PictureFacts& picture, std::size_t) {
    return std::pow(picture.light / first, exponent);
  });
}

/// What is left of the height where each part is taken in one light of its own.
PartLight in_own_light(const std::vector<Evaluation>& evaluations, const FocusCurve& common,
                       const Scatter& scatter) {
  const auto mean = mean_brightness(evaluations);
  const FocusCurve own = sum_of_parts(evaluations, [&](const PictureFacts& picture, std::size_t i) {
    return std::pow(picture.part_brightness[i] / mean[i], scatter.light.exponent);
  });
  constexpr double kBlur = 0.6, kLeast = 0.25;
  const double height = own[common.best()].score - own.floor();
  const double left = std::clamp(height / common.height(), 0.0, 1.0);
  return {.left = left < kBlur ? left : 1,
          .explains_all = left < kLeast || !rise_of(own, scatter).stands_out()};
}

/// The parts' brightness, as parts of that of the picture.
std::array<double, kParts> pattern_of(const PictureFacts& picture) {
  std::array<double, kParts> pattern = picture.part_brightness;
  for (double& part : pattern) part /= picture.light;
  return pattern;
}

/// Standard deviation, over the parts, of what their brightness has changed by beside `far`; grey
/// values.
double pattern_change(const PictureFacts& picture, const std::array<double, kParts>& far) {
  const auto pattern = pattern_of(picture);
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < kParts; ++i) {
    const double change = (pattern[i] - far[i]) * picture.light;
    sum += change / kParts;
    squares += change * change / kParts;
  }
  return std::sqrt(std::max(0.0, squares - sum * sum));
}

/// Slope of the line through scores over what goes with them, times how far that reaches at the top:
/// what it explains of the top's height.
double explained_height(const FocusCurve& curve, const std::vector<double>& with) {
  const auto count = static_cast<double>(curve.size());
  double mean = 0, mean_score = 0, squares = 0, products = 0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    mean += with[i] / count;
    mean_score += curve[i].score / count;
  }
  for (std::size_t i = 0; i < curve.size(); ++i) {
    squares += (with[i] - mean) * (with[i] - mean);
    products += (with[i] - mean) * (curve[i].score - mean_score);
  }
  return squares > 0 ? products / squares * with[curve.best()] : 0;
}

/// Whether the edge of a light or a shadow may have made the peak: the pixels vary more at the top
/// because the parts differ in brightness, and the scores go with that.
bool may_be_an_edge(const std::vector<Evaluation>& evaluations) {
  const FocusCurve curve(evaluations);
  std::array<double, kParts> far{};
  double far_variance = 0;
  const auto low = far_from_focus(curve);
  for (const Evaluation& e : low) {
    const auto pattern = pattern_of(e.picture);
    for (std::size_t i = 0; i < kParts; ++i) far[i] += pattern[i] / static_cast<double>(low.size());
    far_variance += e.picture.deviation * e.picture.deviation / static_cast<double>(low.size());
  }
  std::vector<double> changes;
  for (const Evaluation& e : curve.evaluations()) changes.push_back(pattern_change(e.picture, far));
  constexpr double kOfBlur = 0.4, kMost = 0.5;
  const double change = changes[curve.best()], deviation = curve.top().picture.deviation;
  return change * change > kOfBlur * (deviation * deviation - far_variance) &&
         explained_height(curve, changes) > kMost * curve.height();
}

}  // namespace

PartLight part_light_of(const std::vector<Evaluation>& evaluations, const Scatter& part_scatter) {
  if (evaluations.empty() || !std::all_of(evaluations.begin(), evaluations.end(), is_known))
    return {};
  const FocusCurve common = in_common_light(evaluations, part_scatter.light.exponent);
  if (!rise_of(common, part_scatter).stands_out() || !(common.height() > 0)) return {};
  PartLight light = in_own_light(evaluations, common, part_scatter);
  if (may_be_an_edge(evaluations)) light.left = std::min(light.left, PartLight::kEdge);
  return light;
}

}  // namespace fathom
