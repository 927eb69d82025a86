// SPDX-License-Identifier: Apache-2.0
#include "calibration/range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"

namespace fathom {
namespace {

/// Sample standard deviation of the positions; 0 for a single one.
double scatter_of(std::span<const Peak> peaks, double mean) {
  if (peaks.size() < 2) return 0;
  double squares = 0;
  for (const Peak& peak : peaks) squares += (peak.position - mean) * (peak.position - mean);
  return std::sqrt(squares / static_cast<double>(peaks.size() - 1));
}

/// What the peaks say of one position: the root of their mean square.
double sigma_of(std::span<const Peak> peaks) {
  double squares = 0;
  for (const Peak& peak : peaks) squares += peak.sigma * peak.sigma;
  return std::sqrt(squares / static_cast<double>(peaks.size()));
}

bool any_evaluated(std::span<const Peak> peaks) {
  return std::any_of(peaks.begin(), peaks.end(),
                     [](const Peak& peak) { return peak.shape == PeakShape::none; });
}

}  // namespace

double mean_position(std::span<const Peak> peaks) {
  if (peaks.empty()) throw Error(ErrorCode::bad_argument, "no focused position to range from");
  double sum = 0;
  for (const Peak& peak : peaks) sum += peak.position;
  return sum / static_cast<double>(peaks.size());
}

Distance range_from_peaks(const Calibration& calibration, std::span<const Peak> peaks,
                          double resolution, bool extrapolate, double lasting_sigma) {
  const double position = mean_position(peaks);
  if (!extrapolate && !calibration.covers(position)) {
    throw Error(
        ErrorCode::out_of_bounds,
        fmt::format("the focus at position {:.6g} lies outside of the calibration, {:.6g} to "
                    "{:.6g}; calibrate over a wider range",
                    position, calibration.lowest_position(), calibration.highest_position()));
  }
  const double one_run =
      std::max(calibration.run_sigma(sigma_of(peaks)), scatter_of(peaks, position));
  const double least = any_evaluated(peaks) ? resolution / std::sqrt(12.0) : 0;
  const double sigma = std::max(one_run / std::sqrt(static_cast<double>(peaks.size())), least);
  const Distance distance = calibration.distance(position, std::hypot(sigma, lasting_sigma));
  if (!(distance.mm > 0 && std::isfinite(distance.mm) && std::isfinite(distance.sigma_mm))) {
    throw Error(
        ErrorCode::out_of_bounds,
        fmt::format("the calibration gives no distance at position {:.6g}; calibrate nearer to it",
                    position));
  }
  return distance;
}

}  // namespace fathom
