// SPDX-License-Identifier: Apache-2.0
#include "calibration/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "focus/distributions.hpp"

namespace fathom {
namespace {

double r_squared_of(const Calibration& calibration) {
  double count = 0, sum = 0;
  const auto& points = calibration.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!calibration.left_out(i)) ++count, sum += points[i].distance_mm;
  }
  double residual_squares = 0, total_squares = 0;
  const std::vector<double> residuals = calibration.residuals_mm();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (calibration.left_out(i)) continue;
    residual_squares += residuals[i] * residuals[i];
    total_squares += std::pow(points[i].distance_mm - sum / count, 2);
  }
  return total_squares > 0 ? 1 - residual_squares / total_squares : 0;
}

}  // namespace

Calibration::Calibration(CurveFit fit, std::vector<CalibrationPoint> points,
                         CalibrationConditions conditions)
    : fit_(std::move(fit)), points_(std::move(points)), conditions_(std::move(conditions)) {
  r_squared_ = r_squared_of(*this);
}

Calibration Calibration::fit(CalibrationModel model, std::vector<CalibrationPoint> points,
                             CalibrationConditions conditions) {
  CurveFit fit = fit_curve(model, points);
  return Calibration(std::move(fit), std::move(points), std::move(conditions));
}

std::vector<CalibrationParameter> Calibration::parameters() const {
  std::vector<CalibrationParameter> parameters;
  for (const CalibrationCurve::Natural& natural : fit_.curve.natural()) {
    const double variance = fit_.curve.variance(fit_.spread, natural.gradient);
    const double sigma = freedom() > 0 ? position_scatter() * std::sqrt(variance)
                                       : std::numeric_limits<double>::quiet_NaN();
    parameters.push_back({natural.name, natural.value, sigma});
  }
  return parameters;
}

std::vector<double> Calibration::residuals_mm() const {
  std::vector<double> residuals;
  for (const CalibrationPoint& point : points_) {
    residuals.push_back(point.distance_mm - distance_mm(point.position));
  }
  return residuals;
}

std::vector<double> Calibration::position_residuals() const {
  std::vector<double> residuals;
  for (const CalibrationPoint& point : points_) {
    residuals.push_back(point.position - position_for(point.distance_mm));
  }
  return residuals;
}

double Calibration::position_scatter() const {
  return freedom() > 0 ? fit_.scatter * std::sqrt(small_sample_factor(freedom())) : 0;
}

namespace {

/// The root mean square of what the peaks of the points that have a say said of themselves; 0 if
/// any said nothing.
double typical_sigma(const Calibration& calibration) {
  double squares = 0, count = 0;
  const auto& points = calibration.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (calibration.left_out(i)) continue;
    if (!(points[i].sigma > 0)) return 0;
    squares += points[i].sigma * points[i].sigma;
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : 0;
}

}  // namespace

double Calibration::run_sigma(double peak_sigma) const {
  constexpr int kEnough = 4;  // from here on a scatter is known to a third
  const double typical = typical_sigma(*this);
  if (freedom() < kEnough || typical == 0) return std::max(position_scatter(), peak_sigma);
  const double more = std::max(0.0, peak_sigma * peak_sigma - typical * typical);
  return std::hypot(std::max(position_scatter(), peak_sigma / 2), std::sqrt(more));
}

Distance Calibration::distance(double position, double position_sigma) const {
  const double mm = distance_mm(position);
  const double of_fit = position_scatter() * std::sqrt(fit_.leverage(mm));
  return {mm, std::abs(slope_mm(position)) * std::hypot(position_sigma, of_fit)};
}

DistanceInterval Calibration::interval(double position, double coverage) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  // Beyond this no curve changes, and at infinity itself its formulas are infinity / infinity.
  constexpr double kAsGoodAsInfinity = 1e12;
  const double mm = std::min(distance_mm(position), kAsGoodAsInfinity);
  if (freedom() < 1 || std::isnan(mm)) return {0, kInfinity};
  const double half =
      student_t_within(coverage, freedom()) * fit_.scatter * std::sqrt(1 + fit_.leverage(mm));
  // Positions run toward near or toward far; beyond the last distance of the formula lies infinity.
  const auto end = [&](double at) {
    const double distance = distance_mm(at);
    return std::isnan(distance) ? kInfinity : std::max(0.0, distance);
  };
  const auto [low, high] = std::minmax({end(position - half), end(position + half)});
  return {low, high};
}

namespace {

/// How far beyond the outermost points a position may lie and still be one of theirs.
double margin(const Calibration& calibration, double lowest, double highest) {
  constexpr double kShareOfSpan = 0.01;
  return std::max(3 * calibration.position_scatter(), kShareOfSpan * (highest - lowest));
}

std::pair<double, double> span_of(const Calibration& calibration) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::pair<double, double> span{kInfinity, -kInfinity};
  for (std::size_t i = 0; i < calibration.points().size(); ++i) {
    if (calibration.left_out(i)) continue;
    span.first = std::min(span.first, calibration.points()[i].position);
    span.second = std::max(span.second, calibration.points()[i].position);
  }
  return span;
}

}  // namespace

double Calibration::lowest_position() const {
  const auto [lowest, highest] = span_of(*this);
  return lowest - margin(*this, lowest, highest);
}

double Calibration::highest_position() const {
  const auto [lowest, highest] = span_of(*this);
  return highest + margin(*this, lowest, highest);
}

bool Calibration::covers(double position) const {
  return position >= lowest_position() && position <= highest_position();
}

}  // namespace fathom
