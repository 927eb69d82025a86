// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/optics_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "engine/error.hpp"
#include "tools/fathom/plot.hpp"

namespace fathom::cli {
namespace {

constexpr int kSamples = 400;

/// The marked stops of lenses, each half the light of the one before.
constexpr double kStops[] = {0.7, 1, 1.4, 2, 2.8, 4, 5.6, 8, 11, 16, 22, 32, 45, 64};

/// This f-number between the next wider and the next two narrower stops.
std::vector<double> stops_around(double f_number) {
  const auto ratio = [&](double stop) { return std::abs(std::log(stop / f_number)); };
  const double* const nearest =
      std::min_element(std::begin(kStops), std::end(kStops),
                       [&](double a, double b) { return ratio(a) < ratio(b); });
  std::vector<double> stops{f_number};
  if (nearest > std::begin(kStops)) stops.push_back(*(nearest - 1));
  for (const double* stop = nearest + 1; stop < std::min(nearest + 3, std::end(kStops)); ++stop) {
    stops.push_back(*stop);
  }
  std::sort(stops.begin(), stops.end());
  return stops;
}

/// Samples of a function, evenly spaced; what is infinite is left out.
template <typename Function>
std::vector<Curve::Point> sampled(double from, double to, const Function& function) {
  std::vector<Curve::Point> points;
  for (int i = 0; i <= kSamples; ++i) {
    const double x = from + (to - from) * i / kSamples;
    const double y = function(x);
    if (std::isfinite(y)) points.push_back({x, y});
  }
  return points;
}

/// Where a picture for an object at infinity has its middle.
double finite_distance_mm(const Optics& optics, double object_mm) {
  if (std::isfinite(object_mm)) return object_mm;
  return std::max(optics::hyperfocal_mm(optics), 2 * optics.focal_mm);
}

void write_depth_of_field(const std::filesystem::path& path, const Optics& optics,
                          double object_mm) {
  // Near the hyperfocal distance a curve runs off to infinity and would leave no room for others.
  constexpr double kPart = 0.8;
  const double reach =
      std::min(2 * object_mm, std::max(kPart * optics::hyperfocal_mm(optics), 2 * optics.focal_mm));
  const auto depth_mm = [](const Optics& lens, double distance_mm) {
    return optics::depth_of_field(lens, distance_mm).total_mm();
  };
  std::vector<Curve> curves;
  for (const double stop : stops_around(optics.f_number)) {
    const Optics lens{optics.focal_mm, stop, optics.circle_mm};
    const double end = std::min(reach, kPart * optics::hyperfocal_mm(lens));
    if (end <= lens.focal_mm) continue;
    curves.push_back({CurveStyle::line, fmt::format("f/{:g}", stop),
                      sampled(1.001 * lens.focal_mm, end,
                              [&](double distance_mm) { return depth_mm(lens, distance_mm); })});
  }
  if (curves.empty()) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("all that a {:g} mm lens can focus on looks sharp with a circle of "
                            "confusion of {:g} mm, so there is no figure 3; give a smaller one",
                            optics.focal_mm, optics.circle_mm));
  }
  if (object_mm <= reach) {
    const double depth = depth_mm(optics, object_mm);
    curves.push_back({CurveStyle::mark,
                      fmt::format("{:.3g} mm at {:.6g} mm", depth, object_mm),
                      {{object_mm, depth}}});
  }
  write_curves(path, curves,
               {fmt::format("Depth of field of a {:g} mm lens, circle of confusion {:g} mm",
                            optics.focal_mm, optics.circle_mm),
                "object distance (mm)", "depth of field (mm)", "top left"});
}

void write_mtf(const std::filesystem::path& path, const Optics& optics, double object_mm,
               double wavelength_nm) {
  constexpr int kLast = 8;
  const double f_number = optics::working_f_number(optics, object_mm);
  const double wave_mm = 1 / optics::cutoff_cycles_per_mm(1, wavelength_nm);
  const auto disc_mm = [&](double waves) { return 8 * wave_mm * f_number * waves; };
  std::vector<Curve> curves;
  for (const int n : {0, 1, 2, 4, kLast}) {
    const double waves = n / std::numbers::pi;
    curves.push_back(
        {CurveStyle::line,
         n == 0 ? "n = 0, in focus"
                : fmt::format("n = {}, disc {:.2g} um", n, disc_mm(waves) * 1e3),
         sampled(0, 1, [&](double part) { return std::abs(optics::defocused_otf(part, waves)); })});
  }
  const double cutoff = optics::cutoff_cycles_per_mm(f_number, wavelength_nm);
  const double disc = disc_mm(kLast / std::numbers::pi);
  curves.push_back({CurveStyle::dashed, fmt::format("n = {} by rays alone", kLast),
                    sampled(0, 1, [&](double part) {
                      return std::abs(optics::disc_otf(std::numbers::pi * disc * part * cutoff));
                    })});
  write_curves(
      path, curves,
      {fmt::format("MTF of a perfect lens n/pi wavelengths out of focus, f/{:.3g}, {:g} nm",
                   f_number, wavelength_nm),
       fmt::format("spatial frequency on the sensor (1 = cutoff, {:.3g} cycles/mm)", cutoff),
       "modulation", "top right", 1});
}

void write_object_distance(const std::filesystem::path& path, const Optics& optics,
                           double object_mm) {
  const double focal_mm = optics.focal_mm;
  const double image_mm = optics::image_distance_mm(focal_mm, object_mm);
  const double extension_mm = optics::extension_mm(focal_mm, object_mm);
  // From half to twice the extension: from twice to half the distance, nearly.
  const Curve curve{CurveStyle::line, "",
                    sampled(focal_mm + extension_mm / 2, focal_mm + 2 * extension_mm,
                            [&](double v) { return optics::object_distance_mm(focal_mm, v); })};
  const Curve mark{CurveStyle::mark,
                   fmt::format("{:.6g} mm, image at {:.6g} mm", object_mm, image_mm),
                   {{image_mm, object_mm}}};
  write_curves(path, std::vector<Curve>{curve, mark},
               {fmt::format("What a {:g} mm thin lens is focused on", focal_mm),
                "image distance, lens to sensor (mm)", "object distance (mm)", "top right"});
}

}  // namespace

void write_optics_figures(const std::filesystem::path& folder, const Optics& optics,
                          double object_mm, double wavelength_nm) {
  const double middle_mm = finite_distance_mm(optics, object_mm);
  write_depth_of_field(folder / "figure-3-depth-of-field.svg", optics, middle_mm);
  write_mtf(folder / "figure-4-mtf.svg", optics, object_mm, wavelength_nm);
  write_object_distance(folder / "figure-14-object-distance.svg", optics, middle_mm);
}

}  // namespace fathom::cli
