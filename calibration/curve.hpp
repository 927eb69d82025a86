// SPDX-License-Identifier: Apache-2.0
// A curve between lens position and distance: a model with its parameters, which stay well
// determined where those of the textbook do not.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "model.hpp"

namespace fathom {

/// One target at a known distance and the lens position that focused it.
struct CalibrationPoint {
  double position = 0;     ///< In the lens's unit.
  double distance_mm = 0;  ///< From the lens to the target.
  double sigma = 0;        ///< What its peak said of the position; 0 if unknown.
  /// Of the object there, in focus (calibration/likeness.hpp); empty if unknown.
  std::vector<double> spectrum = {};
};

/// Works in the scaled coordinates of CalibrationScales, so that a curve that is nearly straight is
/// no trouble.
class CalibrationCurve {
 public:
  static constexpr int kMostParameters = CalibrationFormula::kMostParameters;
  using Vector = CalibrationFormula::Vector;
  using Matrix = std::array<Vector, kMostParameters>;
  using LinearRow = CalibrationFormula::LinearRow;
  using Natural = CalibrationFormula::Natural;

  CalibrationCurve() = default;
  /// Takes the scales from the points, which must lie at two distances and positions or more.
  CalibrationCurve(CalibrationModel model, std::span<const CalibrationPoint> points);

  CalibrationModel model() const { return model_; }
  int size() const { return parameter_count(model_); }
  const Vector& b() const { return b_; }
  void set(const Vector& b) { b_ = b; }
  double position_scale() const { return scales_.position_scale; }

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

  /// The point as a linear equation in some x, and the b of an x that solves enough of them.
  LinearRow linear_row(const CalibrationPoint& point) const;
  Vector from_linear(const Vector& x) const;

  /// The parameters of the textbook formula, in its order. inverse: b0 in mm, b1 in mm x positions.
  /// power: b0, the mm at position 1, b1. dioptre: offset_dpt at position
  /// 0, dpt_per_unit of position. thin_lens: focal_length_mm; offset, the position that
  /// focuses infinity; scale_mm, extension per position.
  std::vector<Natural> natural() const;
  /// The textbook formula with the values of its parameters in it.
  std::string equation() const;

 private:
  const CalibrationFormula& formula() const { return model_.formula(); }
  double t_of(double distance_mm) const;
  double distance_of(double t) const;
  double u_of(double position) const {
    return (position - scales_.position_origin) / scales_.position_scale;
  }

  CalibrationModel model_ = CalibrationModel::inverse;
  CalibrationScales scales_;
  Vector b_ = {};
};

}  // namespace fathom
