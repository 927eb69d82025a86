// SPDX-License-Identifier: Apache-2.0
// From lens position to distance, and how far to trust it (thesis T14).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "../engine/window.hpp"
#include "../focus/blur.hpp"
#include "curve.hpp"
#include "fit.hpp"

namespace fathom {

/// A distance with its standard uncertainty.
struct Distance {
  double mm = 0;
  double sigma_mm = 0;
};

/// Where a distance lies with some probability. The far end may be infinity.
struct DistanceInterval {
  double low_mm = 0;
  double high_mm = 0;
};

/// A parameter of the fitted formula. See CalibrationCurve::natural for their names and units.
struct CalibrationParameter {
  std::string name;
  double value = 0;
  double sigma = 0;  ///< Standard uncertainty; NaN where no more points than parameters leave none.
};

/// What was measured with; a range with another rig, metric or window deserves a warning.
struct CalibrationConditions {
  static constexpr int kUnknown = -1;

  std::string rig;                       ///< Descriptions of camera and lens; empty if unknown.
  std::string metric;                    ///< Canonical text; empty if unknown.
  Window window{kUnknown, kUnknown, 0};  ///< Side 0 and corner kUnknown where nobody wrote it down.
  std::string unit;                      ///< Of positions; empty if unknown.
  std::optional<BlurModel> blur = {};    ///< How the lens blurs, where the searches told that.

  /// Whether positions count in another unit than this one, as far as is known.
  bool has_other_unit(const std::string& counted) const { return !unit.empty() && unit != counted; }

  bool operator==(const CalibrationConditions&) const = default;
};

/// A calibration that explains less of the distances than this deserves a warning.
inline constexpr double kPoorRSquared = 0.95;

/// A fitted curve with the points it was fitted to. Immutable.
class Calibration {
 public:
  /// Least squares of the positions, because distances are known and positions scatter, without
  /// outliers (see fit_curve). Throws Error(bad_argument) for fewer points or distances
  /// than the model has parameters, for points that do not determine it (all at one position, or
  /// bent as no lens is), for distances that are not above zero and such positions, where the
  /// model's zero means something.
  static Calibration fit(CalibrationModel model, std::vector<CalibrationPoint> points,
                         CalibrationConditions conditions);

  CalibrationModel model() const { return fit_.curve.model(); }
  /// The formula with its values in it, in one line.
  std::string equation() const { return fit_.curve.equation(); }
  /// Of the formula of the model, in its order.
  std::vector<CalibrationParameter> parameters() const;
  /// All, those that are left out too.
  const std::vector<CalibrationPoint>& points() const { return points_; }
  /// Whether point i is an outlier that has no say in the curve.
  bool left_out(std::size_t i) const { return fit_.left_out[i]; }
  const CalibrationConditions& conditions() const { return conditions_; }

  /// Coefficient of determination of the distances, of the points that have a say.
  double r_squared() const { return r_squared_; }
  /// Measured minus fitted distance of each point, mm; infinite beyond the focus on infinity.
  std::vector<double> residuals_mm() const;
  /// Measured minus fitted position of each point, in the lens's unit.
  std::vector<double> position_residuals() const;
  /// Points that have a say, less parameters.
  int freedom() const { return fit_.freedom; }
  /// Standard uncertainty of one focused position about the curve, in the lens's unit, from the
  /// residuals, and larger for few of them (the variance of Student's t); 0 without any freedom, so
  /// that nothing can be said.
  double position_scatter() const;
  /// Standard uncertainty of one focused position whose peak says `peak_sigma` of itself. Enough
  /// points tell by how much such peaks are really off, so the scatter counts, and what this peak
  /// is less sure of than theirs were; but no peak is believed more than twice as sure as it says.
  /// Of few points it is the larger one of scatter and peak_sigma.
  double run_sigma(double peak_sigma) const;

  /// The positions that the curve may be asked for: those of the points, widened by what the
  /// scatter of a position explains.
  double lowest_position() const;
  double highest_position() const;
  bool covers(double position) const;

  /// The curve, without any check of the range; infinity at or beyond the focus on infinity.
  double distance_mm(double position) const { return fit_.curve.distance_mm(position); }
  /// The position that focuses a distance; NaN where none does.
  double position_for(double distance_mm) const { return fit_.curve.position_for(distance_mm); }
  /// Change of distance per unit of position, mm.
  double slope_mm(double position) const { return fit_.curve.slope_mm(position); }
  /// The distance with its uncertainty: that of the position, through the slope, and that of the
  /// fit.
  Distance distance(double position, double position_sigma) const;
  /// Prediction interval: where the target of one more run that focused at this position lies with
  /// this probability, 0 < coverage < 1. Student's t times the scatter of a position and of the
  /// fit, taken through the curve, so the far side is the longer one. All distances, 0 to infinity,
  /// without any freedom.
  DistanceInterval interval(double position, double coverage = 0.95) const;

  /// As JSON: format "fathom-calibration", version 2. Members that nobody knew are left out and
  /// need not be there. Reading takes version 1 too, throws
  /// Error(bad_data), naming the file, for anything else, and fits again, so that a hand-edited
  /// file cannot disagree with itself.
  std::string json() const;
  static Calibration parse(std::string_view json, std::string_view name);

 private:
  Calibration(CurveFit fit, std::vector<CalibrationPoint> points, CalibrationConditions conditions);

  CurveFit fit_;
  std::vector<CalibrationPoint> points_;
  CalibrationConditions conditions_;
  double r_squared_ = 0;
};

/// Reads points from CSV with a header that names the columns position and distance_mm, in any
/// order. Throws Error(bad_data), naming file and line, for a missing column, a field that is no
/// number, or a distance that is not above zero.
std::vector<CalibrationPoint> parse_calibration_points(std::string_view csv, std::string_view name);

}  // namespace fathom
