// SPDX-License-Identifier: Apache-2.0
// 1/distance = a + b position: a lens that is told a focusing power, as those of webcams and liquid
// lenses are, with its zero anywhere. Scaled, in reciprocals of distances: u = b0 + b1 t.
#include <fmt/format.h>

#include <cmath>

#include "calibration/model.hpp"

namespace fathom {
namespace {

using Formula = CalibrationFormula;
using Vector = Formula::Vector;

constexpr double kDioptres = 1000;  ///< A reciprocal of millimetres.

double u_at(const Vector& b, double t) { return b[0] + b[1] * t; }

double t_at(const Vector& b, double u) { return (u - b[0]) / b[1]; }

double dt_du(const Vector& b, double) { return 1 / b[1]; }

Vector du_db(const Vector&, double t) { return {1, t}; }

Formula::LinearRow linear_row(double t, double u) { return {{1, t}, u}; }

Vector from_linear(const Vector& x) { return x; }

std::vector<Formula::Natural> natural(const Vector& b, const CalibrationScales& scales) {
  const double span = kDioptres * scales.distance_scale,
               nearest = kDioptres / scales.distance_origin;
  const double at_zero = scales.position_origin / scales.position_scale + b[0];
  const double per_unit = -span / (scales.position_scale * b[1]);
  return {{"offset_dpt",
           nearest + span * at_zero / b[1],
           {span / b[1], -span * at_zero / (b[1] * b[1])}},
          {"dpt_per_unit", per_unit, {0, -per_unit / b[1]}}};
}

std::string equation(std::span<const double> natural) {
  return fmt::format("distance = 1000 mm / ({:.6g} {} {:.6g} x position)", natural[0],
                     natural[1] < 0 ? '-' : '+', std::abs(natural[1]));
}

constexpr Formula kFormula = {.name = "dioptre",
                              .summary = "1 / distance = a + b position; webcams, liquid lenses",
                              .parameters = 2,
                              .ruler = DistanceRuler::reciprocals,
                              .takes_any_zero = true,
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

const CalibrationFormula& dioptre_model() { return kFormula; }
constinit const CalibrationModel CalibrationModel::dioptre(kFormula);

}  // namespace fathom
