// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/calibrations.hpp"

#include <cmath>

namespace fathom::reproduce {
namespace {

constexpr int kOwnRepeats = 3;
constexpr double kNearest = 1400, kFarthest = 2600;  // mm, of the thesis' tables (p. 89)

Rig chart(std::size_t transform, const ShouldStop& should_stop) {
  RigChoice choice;
  choice.metric = kTransforms[transform].metric;
  return Rig(options_of(choice, should_stop));
}

void calibrate_old(CalibrationPair& pair, std::size_t t, int points, const ShouldStop& stop) {
  Rig rig = chart(t, stop);
  Dice dice(100 + t);
  for (int i = 0; i < points; ++i) {
    // In the order of distances: the first ones get the points that eight do not divide.
    const int place = i * kCalibrationDistances / points;
    const double distance = calibration_distance_mm(place);
    pair.thesis_runs.push_back(focus_run(rig, distance, thesis_request(distance, dice)));
  }
}

void calibrate_own(CalibrationPair& pair, std::size_t t, int repeats, const ShouldStop& stop) {
  Rig rig = chart(t, stop);
  for (int i = 0; i < kCalibrationDistances; ++i) {
    for (int k = 0; k < repeats; ++k) {
      pair.own_runs.push_back(focus_run(rig, calibration_distance_mm(i), {}));
    }
  }
}

}  // namespace

double calibration_distance_mm(int index) {
  return std::round(kNearest + (kFarthest - kNearest) * index / (kCalibrationDistances - 1));
}

std::vector<CalibrationPoint> points_of(std::span<const FocusRun> runs, bool judged) {
  std::vector<CalibrationPoint> points;
  for (const FocusRun& run : runs) {
    if (run.focused() || !judged) points.push_back({run.position, run.distance_mm});
  }
  return points;
}

double OldCurve::distance_mm(double position) const {
  return model == CalibrationModel::power ? b0 * std::pow(position, b1) : b0 + b1 / position;
}

OldCurve OldCurve::fit(CalibrationModel model, std::span<const CalibrationPoint> points) {
  const bool is_power = model == CalibrationModel::power;
  std::vector<double> x, y, distances, fitted;
  for (const CalibrationPoint& point : points) {
    x.push_back(is_power ? std::log(point.position) : 1 / point.position);
    y.push_back(is_power ? std::log(point.distance_mm) : point.distance_mm);
    distances.push_back(point.distance_mm);
  }
  const Line line = fit_line(x, y);
  OldCurve curve{model, is_power ? std::exp(line.intercept) : line.intercept, line.slope, 0};
  for (const CalibrationPoint& point : points) fitted.push_back(curve.distance_mm(point.position));
  curve.r_squared = r_squared_of(distances, fitted);
  return curve;
}

void plan_calibrations(Calibrations& calibrations, const Effort& effort,
                       const ShouldStop& should_stop, Tasks& tasks) {
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    const int points = effort.quick ? kCalibrationDistances : kThesisCalibrations[t].points;
    CalibrationPair& pair = calibrations[t];
    tasks.emplace_back(
        [&pair, t, points, should_stop] { calibrate_old(pair, t, points, should_stop); });
    const int repeats = effort.quick ? 1 : kOwnRepeats;
    tasks.emplace_back(
        [&pair, t, repeats, should_stop] { calibrate_own(pair, t, repeats, should_stop); });
  }
}

void finish_calibrations(Calibrations& calibrations) {
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    CalibrationPair& pair = calibrations[t];
    const auto old_points = points_of(pair.thesis_runs, false),
               points = points_of(pair.own_runs, true);
    pair.thesis_curve = OldCurve::fit(kThesisCalibrations[t].model, old_points);
    for (const CalibrationPoint& point : old_points) {
      pair.residuals_mm.push_back(point.distance_mm -
                                  pair.thesis_curve.distance_mm(point.position));
    }
    pair.choice = choose_calibration_model(points);
    pair.own = Calibration::fit(pair.choice->model, points, {});
  }
}

}  // namespace fathom::reproduce
