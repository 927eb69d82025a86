// SPDX-License-Identifier: Apache-2.0
// The curves between lens position and distance (thesis T14), as formulas in parameters that stay
// well determined where those of the textbook do not.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

/// One target at a known distance and the lens position that focused it.
struct CalibrationPoint {
  double position = 0;     ///< In the lens's unit.
  double distance_mm = 0;  ///< From the lens to the target.
};

/// The curves that can be fitted.
enum class CalibrationModel {
  inverse,    ///< distance = b0 + b1 / position (eq. 8-2): a thin lens whose extension grows by
              ///< steps from 0 at position 0.
  power,      ///< distance = b0 position^b1, the thesis' curve for Walsh.
  thin_lens,  ///< distance = f + f^2 / (scale (position - offset)) (eq. 3-1): any lens that moves
              ///< as a whole, either way, with 0 steps anywhere.
};

const char* to_string(CalibrationModel model) noexcept;
/// Throws Error(bad_argument), listing the models, for another name.
CalibrationModel parse_calibration_model(std::string_view name);
/// All of them, the one with the fewest parameters first.
std::span<const CalibrationModel> calibration_models();
/// How many distances and points a model needs at least.
int parameter_count(CalibrationModel model);

/// A curve with its parameters. It works in scaled coordinates, t of the distance and u of the
/// position, both of order 1 over the points:
///   inverse    u = 1 / (b0 + b1 t)          t linear in distance
///   power      u = exp(b0 + b1 t)           t linear in the logarithm of the distance
///   thin_lens  u = b0 + b1 t / (1 + b2 t)   t linear in distance; b2 > 0 in every lens
/// so that a fit neither over- nor underflows and a curve that is nearly straight is no trouble.
class CalibrationCurve {
 public:
  static constexpr int kMostParameters = 3;
  using Vector = std::array<double, kMostParameters>;  ///< Only the model's own count.

  using Matrix = std::array<Vector, kMostParameters>;

  CalibrationCurve() = default;
  /// Takes the scales from the points, which must lie at two distances and positions or more.
  CalibrationCurve(CalibrationModel model, std::span<const CalibrationPoint> points);

  CalibrationModel model() const { return model_; }
  int size() const { return parameter_count(model_); }
  const Vector& b() const { return b_; }
  void set(const Vector& b) { b_ = b; }
  double position_scale() const { return position_scale_; }

  /// The position that focuses a distance; NaN where none does.
  double position_for(double distance_mm) const;
  /// The distance that a position focuses: infinity where the lens stands at or beyond its focus on
  /// infinity, NaN where the formula has no distance.
  double distance_mm(double position) const;
  /// Change of distance per unit of position, mm.
  double slope_mm(double position) const;
  /// Change of position_for(distance_mm) with each b.
  Vector gradient(double distance_mm) const;

  /// gradient' spread gradient: the variance of what has this gradient, if spread is that of the b.
  double variance(const Matrix& spread, const Vector& gradient) const;

  /// Each curve through a point is linear in some x: row . x = value. The x of enough points
  /// together, from_linear(x), is a curve through them: exactly, or nearly where they are more.
  struct LinearRow {
    Vector row;
    double value;
  };
  LinearRow linear_row(const CalibrationPoint& point) const;
  Vector from_linear(const Vector& x) const;

  /// A parameter of the textbook formula, and how it changes with each b.
  struct Natural {
    std::string name;
    double value;
    Vector gradient;
  };
  /// inverse: b0 in mm, b1 in mm x positions. power: b0, the mm at position 1, b1. thin_lens:
  /// focal_length_mm; offset, the position that focuses infinity; scale_mm, extension per position.
  std::vector<Natural> natural() const;

 private:
  double t_of(double distance_mm) const;
  double distance_of(double t) const;
  double u_of(double position) const { return (position - position_origin_) / position_scale_; }
  double u_at(double t) const;
  double t_at(double u) const;
  std::vector<Natural> natural_inverse() const;
  std::vector<Natural> natural_power() const;
  std::vector<Natural> natural_thin_lens() const;

  CalibrationModel model_ = CalibrationModel::inverse;
  double distance_origin_ = 0, distance_scale_ = 1;  ///< mm; for power the scale is a logarithm.
  double position_origin_ = 0, position_scale_ = 1;
  Vector b_ = {};
};

}  // namespace fathom
