// SPDX-License-Identifier: Apache-2.0
#include "engine/optics.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "engine/error.hpp"

namespace fathom::optics {
namespace {

using std::numbers::pi;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMmPerNm = 1e-6, kUmPerMm = 1e3;

void require_positive(double value, std::string_view name, std::string_view unit) {
  if (value > 0 && std::isfinite(value)) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("the {} is {}{}; give a number above 0", name, value, unit));
}

void require_not_negative(double value, std::string_view name) {
  if (value >= 0 && std::isfinite(value)) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("the {} is {}; give a number from 0 on", name, value));
}

void require_focal(double focal_mm) { require_positive(focal_mm, "focal length", " mm"); }
void require_f_number(double f_number) { require_positive(f_number, "f-number", ""); }
void require_wavelength(double wavelength_nm) {
  require_positive(wavelength_nm, "wavelength", " nm");
}

/// An object that has a real image. Infinity is fine.
void require_object(double focal_mm, double object_mm) {
  require_focal(focal_mm);
  if (object_mm > focal_mm) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("an object at {} mm has no image behind a {} mm lens; give a distance "
                          "above the focal length",
                          object_mm, focal_mm));
}

/// The nodes and weights of Gauss and Legendre for 8 points on -1 .. 1, one half of each.
struct Node {
  double place, weight;
};
constexpr std::array<Node, 4> kNodes{{{0.1834346424956498, 0.3626837833783620},
                                      {0.5255324099163290, 0.3137066458778873},
                                      {0.7966664774136267, 0.2223810344533745},
                                      {0.9602898564975363, 0.1012285362903763}}};

/// The integral of a function from 0 to `end` in so many panels.
template <typename Function>
double integral(const Function& function, double end, int panels) {
  const double half = end / panels / 2;
  double sum = 0;
  for (int panel = 0; panel < panels; ++panel) {
    const double middle = (2 * panel + 1) * half;
    for (const Node& node : kNodes) {
      const double offset = node.place * half;
      sum += node.weight * (function(middle - offset) + function(middle + offset));
    }
  }
  return sum * half;
}

}  // namespace

void require_valid(const Optics& optics) {
  require_focal(optics.focal_mm);
  require_f_number(optics.f_number);
  require_positive(optics.circle_mm, "circle of confusion", " mm");
}

double image_distance_mm(double focal_mm, double object_mm) {
  require_object(focal_mm, object_mm);
  return std::isinf(object_mm) ? focal_mm : focal_mm * object_mm / (object_mm - focal_mm);
}

double object_distance_mm(double focal_mm, double image_mm) {
  require_focal(focal_mm);
  if (!(image_mm >= focal_mm && std::isfinite(image_mm))) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("no object is in focus on a sensor {} mm behind a {} mm lens; give at "
                            "least the focal length",
                            image_mm, focal_mm));
  }
  return object_at_extension_mm(focal_mm, image_mm - focal_mm);
}

double extension_mm(double focal_mm, double object_mm) {
  require_object(focal_mm, object_mm);
  return focal_mm * focal_mm / (object_mm - focal_mm);
}

double object_at_extension_mm(double focal_mm, double extension_mm) {
  require_focal(focal_mm);
  require_not_negative(extension_mm, "extension in mm");
  return focal_mm + focal_mm * focal_mm / extension_mm;
}

double magnification(double focal_mm, double object_mm) {
  require_object(focal_mm, object_mm);
  return focal_mm / (object_mm - focal_mm);
}

double working_f_number(const Optics& optics, double object_mm) {
  require_f_number(optics.f_number);
  return optics.f_number * (1 + magnification(optics.focal_mm, object_mm));
}

double disc_of_confusion_mm(double focal_mm, double f_number, double image_mm, double sensor_mm) {
  require_focal(focal_mm);
  require_f_number(f_number);
  require_positive(image_mm, "image distance", " mm");
  require_positive(sensor_mm, "sensor's distance", " mm");
  return focal_mm / f_number * std::abs(sensor_mm - image_mm) / image_mm;
}

double disc_per_defocus(const Optics& optics, double object_mm) {
  return 1 / working_f_number(optics, object_mm);
}

DepthOfField depth_of_field(const Optics& optics, double object_mm) {
  require_object(optics.focal_mm, object_mm);
  // Eq. 3-3 divided by X, so that an object at infinity needs no case of its own.
  const double reciprocal = 1 / object_mm, step = 1 / hyperfocal_mm(optics);
  return {1 / (reciprocal + step), reciprocal > step ? 1 / (reciprocal - step) : kInfinity};
}

double hyperfocal_mm(const Optics& optics) {
  require_valid(optics);
  return optics.focal_mm * optics.focal_mm / (optics.circle_mm * optics.f_number);
}

double depth_of_focus_mm(const Optics& optics, double object_mm) {
  require_valid(optics);
  return 2 * optics.circle_mm * working_f_number(optics, object_mm);
}

double airy_radius_um(double focal_mm, double aperture_mm, double wavelength_nm) {
  require_focal(focal_mm);
  require_positive(aperture_mm, "aperture", " mm");
  require_wavelength(wavelength_nm);
  return 1.22 * focal_mm * wavelength_nm * kMmPerNm / aperture_mm * kUmPerMm;
}

double modulation(double largest, double smallest) {
  require_not_negative(smallest, "smallest intensity");
  require_positive(largest, "largest intensity", "");
  if (smallest > largest) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("the smallest intensity, {}, is above the largest, {}; swap them",
                            smallest, largest));
  }
  return (largest - smallest) / (largest + smallest);
}

double cutoff_cycles_per_mm(double working_f_number, double wavelength_nm) {
  require_f_number(working_f_number);
  require_wavelength(wavelength_nm);
  return 1 / (wavelength_nm * kMmPerNm * working_f_number);
}

double diffraction_mtf(double cutoff_part) {
  require_not_negative(cutoff_part, "frequency");
  if (cutoff_part >= 1) return 0;
  return 2 / pi * (std::acos(cutoff_part) - cutoff_part * std::sqrt(1 - cutoff_part * cutoff_part));
}

double defocus_waves(double disc_mm, double working_f_number, double wavelength_nm) {
  require_not_negative(disc_mm, "disc of confusion in mm");
  require_f_number(working_f_number);
  require_wavelength(wavelength_nm);
  return disc_mm / (8 * wavelength_nm * kMmPerNm * working_f_number);
}

double defocused_otf(double cutoff_part, double waves) {
  require_not_negative(cutoff_part, "frequency");
  if (!std::isfinite(waves)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} waves of defocus; give a finite number", waves));
  }
  if (cutoff_part >= 1) return 0;
  // The pupil, a unit disc, and its copy moved by 2 v differ in phase by a x at x from the middle
  // of what they share; across, they share 2 sqrt(1 - (|x| + v)^2). With x = cos t - v the
  // root becomes a smooth sin t.
  const double rate = 8 * pi * std::abs(waves) * cutoff_part;
  // What is left beyond is below 1e-7 and would take long to add up.
  if (rate > 1e5) return 0;
  const double end = std::acos(cutoff_part);
  const auto strip = [&](double t) {
    const double height = std::sin(t);
    return height * height * std::cos(rate * (std::cos(t) - cutoff_part));
  };
  const int panels = 4 + static_cast<int>(rate * end / 2);  // two radians of phase in one, at most
  return 4 / pi * integral(strip, end, panels);
}

double disc_otf(double x) {
  require_not_negative(x, "argument of the disc's transform");
  return x == 0 ? 1 : 2 * ::j1(x) / x;  // j1 is POSIX
}

}  // namespace fathom::optics
