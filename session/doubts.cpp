// SPDX-License-Identifier: Apache-2.0
#include "session/doubts.hpp"

#include <algorithm>
#include <cmath>

#include "session/saturation.hpp"

namespace fathom {
namespace {

constexpr double kSteadyLight = 0.03;  // a lamp that drifts does as much
constexpr double kSteadyNoise = 1.3;   // texture that blur leaves over does as much

/// How far the brightness of a part of the window goes another way than that of the picture: from
/// least to most, of their mean, of the part where that is most. 0 where it is not known.
double unevenness_of(std::span<const Measurement> measurements) {
  double uneven = 0;
  for (std::size_t i = 0; i < kParts; ++i) {
    double least = INFINITY, most = 0;
    for (const Measurement& m : measurements) {
      const double part = m.picture.part_brightness[i] / m.picture.light;
      least = std::min(least, part);
      most = std::max(most, part);
    }
    if (least > 0 && std::isfinite(most))
      uneven = std::max(uneven, 2 * (most - least) / (most + least));
  }
  return uneven;
}

/// left: PartLight::left.
std::optional<LightChanged> light_of(std::span<const Measurement> measurements, double left) {
  double least = INFINITY, most = 0;
  for (const Measurement& m : measurements) {
    least = std::min(least, m.picture.light);
    most = std::max(most, m.picture.light);
  }
  if (!(most > 0)) return std::nullopt;
  const double part = (most - least) / ((most + least) / 2);
  constexpr double kEven = 0.6;  // of the change; half a window that is lit makes more
  const bool is_even = left == 1 && unevenness_of(measurements) < kEven * part;
  if (part <= kSteadyLight && left == 1) return std::nullopt;
  return LightChanged{part, is_even};
}

double squared(double value) { return value * value; }

/// Whether white noise alone makes one picture noisier than the other: then its pixels vary by as
/// much more, and not by the more that texture brings.
bool is_noise_alone(const PictureFacts& least, const PictureFacts& most) {
  constexpr double kTexture = 1.5;
  const double variance = squared(most.deviation) - squared(least.deviation);
  return variance < kTexture * (squared(most.noise) - squared(least.noise));
}

/// Of the pictures beyond a peak, in which fine texture is blurred.
std::optional<NoiseChanged> noise_of(std::span<const Measurement> measurements, double position,
                                     double half_width) {
  constexpr double kBeyond = 3;  // half widths
  const PictureFacts *least = nullptr, *most = nullptr;
  for (const Measurement& m : measurements) {
    if (std::abs(m.position - position) < kBeyond * half_width) continue;
    if (least == nullptr || m.picture.noise < least->noise) least = &m.picture;
    if (most == nullptr || m.picture.noise > most->noise) most = &m.picture;
  }
  if (least == nullptr || !(least->noise > 0) || most->noise <= kSteadyNoise * least->noise ||
      !is_noise_alone(*least, *most))
    return std::nullopt;
  return NoiseChanged{least->noise, most->noise};
}

void tell_of_pictures(std::span<const Measurement> measurements, double position, double half_width,
                      double light_left, Observer& observer) {
  if (const auto saturation = saturation_at(measurements, position)) observer.warned(*saturation);
  if (const auto light = light_of(measurements, light_left)) observer.warned(*light);
  if (const auto noise = noise_of(measurements, position, half_width)) observer.warned(*noise);
}

}  // namespace

void tell_doubts(std::span<const Measurement> measurements, double best, Observer& observer) {
  tell_of_pictures(measurements, best, 0, 1, observer);
}

void tell_doubts(std::span<const Measurement> measurements, const Focus& focus,
                 const LensInfo& lens, Observer& observer) {
  const Peak& peak = focus.peak;
  tell_of_pictures(measurements, peak.position, peak.half_width, focus.verdict.reason.light_left,
                   observer);
  constexpr double kWorthSaying = 0.25;  // of the peak's half width
  const Depths& depths = focus.depths;
  const bool is_answer = focus.result() == FocusResult::focused;
  if (!is_answer || depths.spread <= kWorthSaying * peak.half_width || depths.parts.empty()) return;
  observer.warned(Receding{.from = depths.parts.front().position,
                           .to = depths.parts.back().position,
                           .spread = depths.spread,
                           .unit = lens.unit});
}

}  // namespace fathom
