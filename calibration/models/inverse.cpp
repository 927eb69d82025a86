// SPDX-License-Identifier: Apache-2.0
// distance = b0 + b1 / position (thesis eq. 8-2): a thin lens whose extension grows by steps from 0
// at position 0. Scaled: u = 1 / (b0 + b1 t).
#include <fmt/format.h>

#include <limits>

#include "calibration/model.hpp"

namespace fathom {
namespace {

using Formula = CalibrationFormula;
using Vector = Formula::Vector;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double u_at(const Vector& b, double t) {
  const double inverse = b[0] + b[1] * t;
  return inverse > 0 ? 1 / inverse : kNaN;
}

double t_at(const Vector& b, double u) {
  if (u > 0) return (1 / u - b[0]) / b[1];
  return b[1] > 0 ? kInfinity : kNaN;
}

double dt_du(const Vector& b, double u) { return -1 / (b[1] * u * u); }

Vector du_db(const Vector& b, double t) {
  const double u = u_at(b, t);
  return {-u * u, -u * u * t};
}

Formula::LinearRow linear_row(double t, double u) { return {{u, u * t}, 1}; }

Vector from_linear(const Vector& x) { return x; }

std::vector<Formula::Natural> natural(const Vector& b, const CalibrationScales& scales) {
  const double alpha = b[0], beta = b[1], span = scales.distance_scale;
  const double b1 = scales.position_scale * span / beta;
  return {{"b0",
           scales.distance_origin - alpha * span / beta,
           {-span / beta, alpha * span / (beta * beta)}},
          {"b1", b1, {0, -b1 / beta}}};
}

std::string equation(std::span<const double> natural) {
  return fmt::format("distance = {:.6g} mm + {:.6g} mm / position", natural[0], natural[1]);
}

constexpr Formula kFormula = {.name = "inverse",
                              .summary = "distance = b0 + b1 / position",
                              .parameters = 2,
                              .ruler = DistanceRuler::distances,
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

const CalibrationFormula& inverse_model() { return kFormula; }
constinit const CalibrationModel CalibrationModel::inverse(kFormula);

}  // namespace fathom
