// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/objective.hpp"

#include <cmath>
#include <limits>

#include "hal/drivers/simulated/motor.hpp"
#include "hal/drivers/simulated/thin_lens.hpp"

namespace fathom::simulated {
namespace {

constexpr double kWebcamFocalMm = 4;
constexpr double kWebcamPitchMm = 0.006;
constexpr double kWebcamFarthestPower = -0.0005;  ///< 1/mm: beyond infinity, as most of them go.
constexpr double kWebcamNearestPower = 0.01;      ///< 100 mm.
constexpr int kWebcamTravel = 255;

/// Reciprocal of the distance in focus, 1/mm.
double webcam_power(double position) {
  return kWebcamFarthestPower +
         position / kWebcamTravel * (kWebcamNearestPower - kWebcamFarthestPower);
}

/// From the lens to the sensor, by 1/f = 1/object + 1/image.
double webcam_image_mm(double position) {
  return 1 / (1 / kWebcamFocalMm - webcam_power(position));
}

double webcam_focused_mm(double position) {
  const double power = webcam_power(position);
  return power > 0 ? 1 / power : std::numeric_limits<double>::infinity();
}

/// Aperture times image distance times the difference of focusing powers.
double webcam_disc_mm(double position, double distance_mm, double f_number) {
  const double off = std::abs(webcam_power(position) - 1 / distance_mm);
  const double disc_mm = kWebcamFocalMm / f_number * webcam_image_mm(position) * off;
  return disc_mm * kPitchMm / kWebcamPitchMm;
}

double webcam_pixel_mm(double position, double distance_mm) {
  return kWebcamPitchMm * distance_mm / webcam_image_mm(position);
}

/// Kept while the lens moves, as the thesis does.
double thesis_pixel_mm(double, double distance_mm) { return kPitchMm / magnification(distance_mm); }

constexpr Objective kThesis = {.name = "thesis",
                               .unit = "steps",
                               .travel = kTravelSteps,
                               .focal_mm = kFocalLengthMm,
                               .usual_f_number = 4,
                               .nearest_target_mm = 1230,
                               .farthest_target_mm = 10000,
                               .usual_distance_mm = 1800,
                               .rate_per_s = 25,
                               .stall_rate = kStallRate,
                               .play = 4,
                               .breathes = false,
                               .is_compressed = false,
                               .tells_optics = true,
                               .focused_distance_mm = focused_distance_mm,
                               .disc_mm = disc_of_confusion_mm,
                               .pixel_on_object_mm = thesis_pixel_mm};

constexpr Objective kWebcam = {.name = "webcam",
                               .unit = "units",
                               .travel = kWebcamTravel,
                               .focal_mm = kWebcamFocalMm,
                               .usual_f_number = 2,
                               .nearest_target_mm = 105,
                               .farthest_target_mm = 3000,
                               .usual_distance_mm = 300,
                               .rate_per_s = 1000,
                               .stall_rate = std::numeric_limits<double>::infinity(),
                               .play = 0,
                               .breathes = true,
                               .is_compressed = true,
                               .tells_optics = false,
                               .focused_distance_mm = webcam_focused_mm,
                               .disc_mm = webcam_disc_mm,
                               .pixel_on_object_mm = webcam_pixel_mm};

}  // namespace

const Objective& thesis_objective() { return kThesis; }
const Objective& webcam_objective() { return kWebcam; }

}  // namespace fathom::simulated
