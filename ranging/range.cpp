// SPDX-License-Identifier: Apache-2.0
#include "ranging/range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/error.hpp"

namespace fathom {
namespace {

/// Sample standard deviation; 0 for a single value.
double scatter_of(std::span<const double> values, double mean) {
  if (values.size() < 2) return 0;
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

/// Standard deviation of a value that may lie anywhere in an interval.
double sigma_within(double interval) { return interval / std::sqrt(12.0); }

}  // namespace

double mean_position(std::span<const double> positions) {
  if (positions.empty()) throw Error(ErrorCode::bad_argument, "no focused position to range from");
  return std::accumulate(positions.begin(), positions.end(), 0.0) /
         static_cast<double>(positions.size());
}

Distance range_from_positions(const Calibration& calibration, std::span<const double> positions,
                              double tolerance, double resolution, bool extrapolate) {
  const double position = mean_position(positions);
  if (!extrapolate && !calibration.covers(position)) {
    throw Error(
        ErrorCode::out_of_bounds,
        fmt::format("the focus at position {:.6g} lies outside of the calibration, {:.6g} to "
                    "{:.6g}; calibrate over a wider range, or ask for --extrapolate",
                    position, calibration.lowest_position(), calibration.highest_position()));
  }
  const double runs = static_cast<double>(positions.size());
  const double one_run = std::max({calibration.position_scatter(), scatter_of(positions, position),
                                   sigma_within(std::max(tolerance, resolution))});
  const double sigma = std::max(one_run / std::sqrt(runs), sigma_within(resolution));
  const Distance distance = calibration.distance(position, sigma);
  if (!(distance.mm > 0 && std::isfinite(distance.mm) && std::isfinite(distance.sigma_mm))) {
    throw Error(
        ErrorCode::out_of_bounds,
        fmt::format("the calibration gives no distance at position {:.6g}; calibrate nearer to it",
                    position));
  }
  return distance;
}

}  // namespace fathom
