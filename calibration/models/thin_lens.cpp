// SPDX-License-Identifier: Apache-2.0
// distance = f + f^2 / (scale (position - offset)) (thesis eq. 3-1): any lens that moves as a
// whole, either way, with its zero anywhere. Scaled: u = b0 + b1 t / (1 + b2 t), b2 > 0 in every
// lens.
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

double u_at(const Vector& b, double t) {
  const double beyond_focal_length = 1 + b[2] * t;
  return beyond_focal_length > 0 ? b[0] + b[1] * t / beyond_focal_length : kNaN;
}

double t_at(const Vector& b, double u) {
  const double w = u - b[0];
  const double left = b[1] - b[2] * w;  // of the way to the focus on infinity
  return left / b[1] > 0 ? w / left : kInfinity;
}

double dt_du(const Vector& b, double u) {
  const double left = b[1] - b[2] * (u - b[0]);
  return b[1] / (left * left);
}

Vector du_db(const Vector& b, double t) {
  const double reach = t / (1 + b[2] * t);
  return {1, reach, -b[1] * reach * reach};
}

Formula::LinearRow linear_row(double t, double u) { return {{1, t, -t * u}, u}; }

Vector from_linear(const Vector& x) { return {x[0], x[1] - x[2] * x[0], x[2]}; }

std::vector<Formula::Natural> natural(const Vector& b, const CalibrationScales& scales) {
  const double B = b[1], g = b[2], span = scales.distance_scale, unit = scales.position_scale;
  const double f = scales.distance_origin - span / g;
  const double k = -unit * span * B / (g * g);  // position = offset + k / (distance - f)
  const double f_by_g = span / (g * g);
  const double scale = f * f / k;
  return {{"focal_length_mm", f, {0, 0, f_by_g}},
          {"offset",  // the position that focuses infinity
           scales.position_origin + unit * (b[0] + B / g),
           {unit, unit / g, -unit * B / (g * g)}},
          {"scale_mm", scale, {0, -scale / B, 2 * f / k * f_by_g + 2 * scale / g}}};
}

std::string equation(std::span<const double> natural) {
  const double f = natural[0], offset = natural[1], scale = natural[2];
  return fmt::format("distance = f + f^2 / e, f = {:.6g} mm, e = {:.6g} mm x (position {} {:.6g})",
                     f, scale, offset < 0 ? '+' : '-', std::abs(offset));
}

/// A lens bends the curve one way.
const char* objection(const Vector& b) {
  if (b[2] > 0) return nullptr;
  return "these points bend less than any thin lens; measure a wider range of distances, or take "
         "another model";
}

constexpr Formula kFormula = {
    .name = "thin-lens",
    .summary = "focal length, offset and scale; a lens of either direction",
    .parameters = 3,
    .ruler = DistanceRuler::distances,
    .takes_any_zero = true,
    .u_at = u_at,
    .t_at = t_at,
    .dt_du = dt_du,
    .du_db = du_db,
    .linear_row = linear_row,
    .from_linear = from_linear,
    .natural = natural,
    .equation = equation,
    .objection = objection};

}  // namespace

const CalibrationFormula& thin_lens_model() { return kFormula; }
constinit const CalibrationModel CalibrationModel::thin_lens(kFormula);

}  // namespace fathom
