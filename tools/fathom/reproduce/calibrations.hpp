// SPDX-License-Identifier: Apache-2.0
// Figures 15 to 20: the lens positions that focus a chart at known distances, and curves through
// them.
#pragma once

#include <array>
#include <optional>

#include "calibration/calibration.hpp"
#include "calibration/choice.hpp"
#include "tools/fathom/reproduce/measuring.hpp"
#include "tools/fathom/reproduce/statistics.hpp"

namespace fathom::reproduce {

/// The thesis says eight distances, not which; these are spread over the range of its tables.
inline constexpr int kCalibrationDistances = 8;
double calibration_distance_mm(int index);

/// What the thesis fitted to each transform's points (eqs. 8-2 to 8-7).
struct ThesisCalibration {
  int points;
  CalibrationModel model;
  double r_squared;
  int figure;  ///< Of the curve; the next one shows the residuals.
  int page;
};
inline const ThesisCalibration kThesisCalibrations[kTransformCount] = {
    {51, CalibrationModel::inverse, 0.9987, 15, 68},
    {33, CalibrationModel::power, 0.9987, 17, 70},
    {34, CalibrationModel::power, 0.9979, 19, 72}};

/// A curve fitted as the statistics packages of 1989 did: a straight line through distances against
/// 1/position (inverse), or through their logarithms (power).
struct OldCurve {
  CalibrationModel model = CalibrationModel::inverse;
  double b0 = 0, b1 = 0;
  double r_squared = 0;  ///< Of the distances.

  double distance_mm(double position) const;
  static OldCurve fit(CalibrationModel model, std::span<const CalibrationPoint> points);
};

/// Of one transform.
struct CalibrationPair {
  std::vector<FocusRun> thesis_runs, own_runs;
  OldCurve thesis_curve;
  std::vector<double> residuals_mm;  ///< Of the thesis_runs: actual less fitted.
  std::optional<ModelChoice> choice;
  std::optional<Calibration> own;
};
using Calibrations = std::array<CalibrationPair, kTransformCount>;

void plan_calibrations(Calibrations& calibrations, const Effort& effort,
                       const ShouldStop& should_stop, Tasks& tasks);
void finish_calibrations(Calibrations& calibrations);

/// The points of the runs; judged: only of those that focused. The thesis' search knew no verdict.
std::vector<CalibrationPoint> points_of(std::span<const FocusRun> runs, bool judged);

}  // namespace fathom::reproduce
