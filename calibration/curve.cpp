// SPDX-License-Identifier: Apache-2.0
#include "calibration/curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom {
namespace {

/// What t counts in, growing with the distance.
double on_ruler(DistanceRuler ruler, double distance_mm) {
  switch (ruler) {
    case DistanceRuler::distances:
      return distance_mm;
    case DistanceRuler::logarithms:
      return std::log(distance_mm);
    case DistanceRuler::reciprocals:
      return -1 / distance_mm;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

/// How many mm a little more on the ruler is.
double mm_on_ruler(DistanceRuler ruler, double distance_mm) {
  switch (ruler) {
    case DistanceRuler::distances:
      return 1;
    case DistanceRuler::logarithms:
      return distance_mm;
    case DistanceRuler::reciprocals:
      return distance_mm * distance_mm;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

/// Origin and scale by the nearest and farthest distance, and by the lowest and highest position.
CalibrationScales scales_of(const CalibrationFormula& formula,
                            std::span<const CalibrationPoint> points) {
  const auto [near, far] = std::minmax_element(
      points.begin(), points.end(), [](const CalibrationPoint& a, const CalibrationPoint& b) {
        return a.distance_mm < b.distance_mm;
      });
  const auto [low, high] = std::minmax_element(
      points.begin(), points.end(),
      [](const CalibrationPoint& a, const CalibrationPoint& b) { return a.position < b.position; });
  CalibrationScales scales;
  scales.distance_origin = near->distance_mm;
  scales.distance_scale =
      on_ruler(formula.ruler, far->distance_mm) - on_ruler(formula.ruler, near->distance_mm);
  if (formula.takes_any_zero) {
    scales.position_origin = low->position;
    scales.position_scale = high->position - low->position;
  } else {
    scales.position_scale =
        high->position;  // Their zero means something, so only the unit is free.
  }
  return scales;
}

}  // namespace

CalibrationCurve::CalibrationCurve(CalibrationModel model, std::span<const CalibrationPoint> points)
    : model_(model), scales_(scales_of(model.formula(), points)) {}

double CalibrationCurve::t_of(double distance_mm) const {
  const DistanceRuler ruler = formula().ruler;
  return (on_ruler(ruler, distance_mm) - on_ruler(ruler, scales_.distance_origin)) /
         scales_.distance_scale;
}

double CalibrationCurve::distance_of(double t) const {
  const double origin = scales_.distance_origin, beyond = scales_.distance_scale * t;
  switch (formula().ruler) {
    case DistanceRuler::distances:
      return origin + beyond;
    case DistanceRuler::logarithms:
      return origin * std::exp(beyond);
    case DistanceRuler::reciprocals: {
      const double left = 1 / origin - beyond;  // of the way to the focus on infinity
      return left <= 0 ? std::numeric_limits<double>::infinity() : 1 / left;
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double CalibrationCurve::position_for(double distance_mm) const {
  return scales_.position_origin + scales_.position_scale * formula().u_at(b_, t_of(distance_mm));
}

double CalibrationCurve::distance_mm(double position) const {
  if (!std::isfinite(position)) return std::numeric_limits<double>::quiet_NaN();
  return distance_of(formula().t_at(b_, u_of(position)));
}

double CalibrationCurve::slope_mm(double position) const {
  const double u = u_of(position);
  const double mm_per_t =
      scales_.distance_scale * mm_on_ruler(formula().ruler, distance_of(formula().t_at(b_, u)));
  return mm_per_t * formula().dt_du(b_, u) / scales_.position_scale;
}

CalibrationCurve::Vector CalibrationCurve::gradient(double distance_mm) const {
  Vector gradient = formula().du_db(b_, t_of(distance_mm));
  for (double& change : gradient) change *= scales_.position_scale;
  return gradient;
}

double CalibrationCurve::variance(const Matrix& spread, const Vector& gradient) const {
  double sum = 0;
  for (int i = 0; i < size(); ++i) {
    for (int j = 0; j < size(); ++j) sum += gradient[i] * spread[i][j] * gradient[j];
  }
  return std::max(0.0, sum);
}

CalibrationCurve::LinearRow CalibrationCurve::linear_row(const CalibrationPoint& point) const {
  return formula().linear_row(t_of(point.distance_mm), u_of(point.position));
}

CalibrationCurve::Vector CalibrationCurve::from_linear(const Vector& x) const {
  return formula().from_linear(x);
}

std::vector<CalibrationCurve::Natural> CalibrationCurve::natural() const {
  return formula().natural(b_, scales_);
}

std::string CalibrationCurve::equation() const {
  std::vector<double> values;
  for (const Natural& parameter : natural()) values.push_back(parameter.value);
  return formula().equation(values);
}

}  // namespace fathom
