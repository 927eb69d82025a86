// SPDX-License-Identifier: Apache-2.0
// distance = b0 position^b1, the thesis' curve for Walsh. Scaled: u = exp(b0 + b1 t).
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "calibration/model.hpp"

namespace fathom {
namespace {

using Formula = CalibrationFormula;
using Vector = Formula::Vector;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double u_at(const Vector& b, double t) { return std::exp(b[0] + b[1] * t); }

double t_at(const Vector& b, double u) {
  if (u > 0) return (std::log(u) - b[0]) / b[1];
  return b[1] < 0 ? kInfinity : kNaN;
}

double dt_du(const Vector& b, double u) { return 1 / (b[1] * u); }

Vector du_db(const Vector& b, double t) {
  const double u = u_at(b, t);
  return {u, u * t};
}

Formula::LinearRow linear_row(double t, double u) { return {{1, t}, std::log(u)}; }

Vector from_linear(const Vector& x) { return x; }

std::vector<Formula::Natural> natural(const Vector& b, const CalibrationScales& scales) {
  const double c = b[1], b1 = scales.distance_scale / c;
  const double log_unit = std::log(scales.position_scale) + b[0];
  const double b0 = std::exp(std::log(scales.distance_origin) - b1 * log_unit);
  return {{"b0", b0, {-b0 * b1, b0 * b1 * log_unit / c}}, {"b1", b1, {0, -b1 / c}}};
}

std::string equation(std::span<const double> natural) {
  return fmt::format("distance = {:.6g} mm x position ^ {:.6g}", natural[0], natural[1]);
}

constexpr Formula kFormula = {.name = "power",
                              .summary = "b0 position^b1",
                              .parameters = 2,
                              .ruler = DistanceRuler::logarithms,
                              .takes_any_zero = false,
                              .u_at = u_at,
                              .t_at = t_at,
                              .dt_du = dt_du,
                              .du_db = du_db,
                              .linear_row = linear_row,
                              .from_linear = from_linear,
                              .natural = natural,
                              .equation = equation,
                              .objection = nullptr};

}  // namespace

const CalibrationFormula& power_model() { return kFormula; }
constinit const CalibrationModel CalibrationModel::power(kFormula);

}  // namespace fathom
