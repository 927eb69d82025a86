// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/thin_lens.hpp"

#include <cmath>

namespace fathom::simulated {
namespace {

constexpr double kLongestExtensionMm =
    kFocalLengthMm * kFocalLengthMm / (kNearestMm - kFocalLengthMm);

}  // namespace

double extension_mm(double position_steps) {
  return position_steps / kTravelSteps * kLongestExtensionMm;
}

double focused_distance_mm(double position_steps) {
  return kFocalLengthMm + kFocalLengthMm * kFocalLengthMm / extension_mm(position_steps);
}

double focused_position_steps(double distance_mm) {
  const double extension = kFocalLengthMm * kFocalLengthMm / (distance_mm - kFocalLengthMm);
  return kTravelSteps * extension / kLongestExtensionMm;
}

double disc_of_confusion_mm(double position_steps, double distance_mm, double f_number) {
  const double sensor_mm = kFocalLengthMm + extension_mm(position_steps);
  const double image_mm = kFocalLengthMm * distance_mm / (distance_mm - kFocalLengthMm);
  return kFocalLengthMm / f_number * std::abs(sensor_mm - image_mm) / image_mm;
}

double magnification(double distance_mm) { return kFocalLengthMm / (distance_mm - kFocalLengthMm); }

}  // namespace fathom::simulated
