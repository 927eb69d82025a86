// SPDX-License-Identifier: Apache-2.0
// From lens position to distance, and how far to trust it (thesis T14).
#pragma once

#include <filesystem>
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
  inverse,  ///< distance = b0 + b1 / position (eq. 8-2): a thin lens whose extension grows by
            ///< steps.
};

const char* to_string(CalibrationModel model) noexcept;
/// Throws Error(bad_argument), listing the models, for another name.
CalibrationModel parse_calibration_model(std::string_view name);

/// A distance with its standard uncertainty.
struct Distance {
  double mm = 0;
  double sigma_mm = 0;
};

/// What was measured with; a range with another rig, metric or window deserves a warning.
struct CalibrationConditions {
  std::string rig;     ///< Descriptions of camera and lens.
  std::string metric;  ///< Canonical text.
  int window_side = 0;
  std::string unit;  ///< Of positions.

  bool operator==(const CalibrationConditions&) const = default;
};

/// A fitted curve. Immutable.
class Calibration {
 public:
  /// Least squares in distance, as the thesis did. Throws Error(bad_argument) for fewer points than
  /// the model has parameters, for points that do not determine it (all at one position), and for
  /// positions or distances that are not above zero.
  static Calibration fit(CalibrationModel model, std::vector<CalibrationPoint> points,
                         CalibrationConditions conditions);

  CalibrationModel model() const { return model_; }
  double b0() const { return b0_; }
  double b1() const { return b1_; }
  const std::vector<CalibrationPoint>& points() const { return points_; }
  const CalibrationConditions& conditions() const { return conditions_; }

  /// Coefficient of determination of the distances.
  double r_squared() const { return r_squared_; }
  /// Measured minus fitted distance of each point, mm.
  std::vector<double> residuals_mm() const;
  /// Scatter of one focused position about the curve, in the lens's unit, from the residuals; 0 if
  /// there are no more points than parameters, so that nothing can be said.
  double position_scatter() const { return position_scatter_; }

  /// The positions that the curve may be asked for: those of the points, widened by what the
  /// scatter of a position explains.
  double lowest_position() const;
  double highest_position() const;
  bool covers(double position) const;

  /// The curve, without any check of the range.
  double distance_mm(double position) const;
  /// Change of distance per unit of position, mm.
  double slope_mm(double position) const;
  /// The distance with its uncertainty: that of the position, through the slope, and that of the
  /// fit.
  Distance distance(double position, double position_sigma) const;

  /// As JSON: format "fathom-calibration", version 1. Reading throws Error(bad_data), naming the
  /// file, for anything else, and fits again, so that a hand-edited file cannot disagree with
  /// itself.
  std::string json() const;
  static Calibration parse(std::string_view json, std::string_view name);

 private:
  Calibration() = default;
  double fit_variance_mm2(double position) const;

  CalibrationModel model_ = CalibrationModel::inverse;
  std::vector<CalibrationPoint> points_;
  CalibrationConditions conditions_;
  double b0_ = 0;
  double b1_ = 0;
  double r_squared_ = 0;
  double position_scatter_ = 0;
  double covariance_[2][2] = {};  ///< Of b0 and b1, mm units.
};

/// Reads points from CSV with a header that names the columns position and distance_mm, in any
/// order. Throws Error(bad_data), naming file and line, for a missing column or a field that is no
/// number.
std::vector<CalibrationPoint> parse_calibration_points(std::string_view csv, std::string_view name);

}  // namespace fathom
