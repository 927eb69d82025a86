// SPDX-License-Identifier: Apache-2.0
#include "calibration/growth.hpp"

#include <cmath>

#include "engine/optics.hpp"

namespace fathom {
namespace {

constexpr double kByOptics = 0.1, kByFit = 0.3, kByBlur = 2;  // of itself

std::optional<double> focal_mm(const Calibration& calibration) {
  for (const CalibrationParameter& parameter : calibration.parameters()) {
    if (parameter.name == "focal_length_mm" && parameter.value > 0) return parameter.value;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Growth> growth_of(const Calibration& calibration, double position,
                                const std::optional<Optics>& optics) {
  const auto focal = optics ? std::optional(optics->focal_mm) : focal_mm(calibration);
  const double middle = (calibration.lowest_position() + calibration.highest_position()) / 2;
  const double distance = calibration.distance_mm(middle), slope = calibration.slope_mm(middle);
  if (!focal || !(distance > *focal) || !std::isfinite(distance) || !std::isfinite(slope))
    return std::nullopt;
  const double magnification = optics::magnification(*focal, distance);
  const double way = -magnification * magnification * slope;
  const double image = optics::image_distance_mm(*focal, distance) + way * (position - middle);
  if (!(image > 0)) return std::nullopt;
  const double per_unit = way / image;
  return Growth{.per_unit = per_unit, .sigma = (optics ? kByOptics : kByFit) * std::abs(per_unit)};
}

Growth growth_of(const Optics& optics, const BlurModel& blur) {
  const double per_unit = blur.px_per_unit * optics.circle_mm * optics.f_number / optics.focal_mm;
  return {.per_unit = per_unit, .sigma = kByBlur * per_unit};
}

}  // namespace fathom
