// SPDX-License-Identifier: Apache-2.0
#include "session/kept_surface.hpp"

#include <cmath>

namespace fathom {
namespace {

/// By how much the mean distance of positions that spread lies beyond the distance of their mean.
double bend_mm(const Calibration& calibration, const KeptSurface& surface) {
  const double relief = surface.relief;
  if (!(relief > 0)) return 0;
  const double bend = (calibration.slope_mm(surface.position + relief) -
                       calibration.slope_mm(surface.position - relief)) /
                      (2 * relief);
  return std::isfinite(bend) ? bend * relief * relief / 2 : 0;
}

}  // namespace

double place_sigma(const KeptSurface& surface) { return std::hypot(surface.sigma, surface.relief); }

std::optional<Distance> distance_of(const Calibration& calibration, const KeptSurface& surface,
                                    bool extrapolate) {
  if (!extrapolate && !calibration.covers(surface.position)) return std::nullopt;
  const double sigma = std::hypot(place_sigma(surface), calibration.position_scatter());
  Distance distance = calibration.distance(surface.position, sigma);
  if (!std::isfinite(distance.mm)) return std::nullopt;
  distance.mm += bend_mm(calibration, surface);
  return distance;
}

}  // namespace fathom
