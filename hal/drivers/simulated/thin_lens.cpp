// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/thin_lens.hpp"

namespace fathom::simulated {
namespace {

double longest_extension_mm() { return optics::extension_mm(kFocalLengthMm, kNearestMm); }

}  // namespace

double extension_mm(double position_steps) {
  return position_steps / kTravelSteps * longest_extension_mm();
}

double focused_distance_mm(double position_steps) {
  return optics::object_at_extension_mm(kFocalLengthMm, extension_mm(position_steps));
}

double focused_position_steps(double distance_mm) {
  return kTravelSteps * optics::extension_mm(kFocalLengthMm, distance_mm) / longest_extension_mm();
}

double disc_of_confusion_mm(double position_steps, double distance_mm, double f_number) {
  return optics::disc_of_confusion_mm(kFocalLengthMm, f_number,
                                      optics::image_distance_mm(kFocalLengthMm, distance_mm),
                                      kFocalLengthMm + extension_mm(position_steps));
}

double magnification(double distance_mm) {
  return optics::magnification(kFocalLengthMm, distance_mm);
}

}  // namespace fathom::simulated
