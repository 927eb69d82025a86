// SPDX-License-Identifier: Apache-2.0
#include "calibration/range.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/error.hpp"

namespace fathom {
namespace {

Calibration curve(double scatter) {
  std::vector<CalibrationPoint> points;
  for (int i = 0; i <= 20; ++i) {
    const double position = 500 + 25.0 * i;
    // Alternating errors give a scatter without a random generator.
    points.push_back({position + (i % 2 ? scatter : -scatter), 135 + 1.3e6 / position});
  }
  return Calibration::fit(CalibrationModel::inverse, points, {});
}

/// Peaks known to `sigma`, at these positions.
std::vector<Peak> peaks_at(const std::vector<double>& positions, double sigma = 0.3) {
  std::vector<Peak> peaks;
  for (const double position : positions) {
    Peak& peak = peaks.emplace_back();
    peak.shape = PeakShape::gaussian;
    peak.position = position;
    peak.sigma = sigma;
  }
  return peaks;
}

TEST(Range, IsTheCurveAtTheMeanPosition) {
  const Calibration calibration = curve(1);
  const auto peaks = peaks_at({700, 702, 704});
  const Distance d = range_from_peaks(calibration, peaks, 1, false);
  EXPECT_EQ(d.mm, calibration.distance_mm(702));
}

TEST(Range, RepeatsNarrowTheSigma) {
  const Calibration calibration = curve(3);
  const Distance one = range_from_peaks(calibration, peaks_at({700}), 1, false);
  const Distance nine =
      range_from_peaks(calibration, peaks_at(std::vector<double>(9, 700.0)), 1, false);
  EXPECT_LT(nine.sigma_mm, one.sigma_mm / 2);
}

TEST(Range, RunsThatDisagreeWidenTheSigma) {
  const Calibration calibration = curve(1);
  const Distance close = range_from_peaks(calibration, peaks_at({699, 700, 701}), 1, false);
  const Distance wide = range_from_peaks(calibration, peaks_at({650, 700, 750}), 1, false);
  EXPECT_GT(wide.sigma_mm, 5 * close.sigma_mm);
}

TEST(Range, EvaluatedPositionsAreNeverBetterThanTheLensResolution) {
  const Calibration calibration = curve(0);
  const std::vector<Peak> peaks(100, evaluated_peak({1, 700, 1}, 2));
  const Distance d = range_from_peaks(calibration, peaks, 1, false);
  EXPECT_GE(d.sigma_mm, std::abs(calibration.slope_mm(700)) / std::sqrt(12.0) * 0.999);
}

TEST(Range, OneEvaluatedPositionIsNoBetterThanTheIntervalItsSearchEndsWith) {
  const Calibration calibration = curve(0);
  const Distance d =
      range_from_peaks(calibration, std::vector<Peak>{evaluated_peak({1, 700, 1}, 6)}, 1, false);
  EXPECT_NEAR(d.sigma_mm, std::abs(calibration.slope_mm(700)) * 6 / std::sqrt(12.0), 1e-6);
}

TEST(Range, OneFittedPositionIsNoBetterThanItsFit) {
  const Calibration calibration = curve(0);
  const Distance d = range_from_peaks(calibration, peaks_at({700}, 0.4), 1, false);
  EXPECT_NEAR(d.sigma_mm, std::abs(calibration.slope_mm(700)) * 0.4, 1e-6);
}

TEST(Range, RefusesToLeaveTheCalibrationUnlessAsked) {
  const Calibration calibration = curve(1);
  for (const double position : {400.0, 1100.0}) {
    try {
      range_from_peaks(calibration, peaks_at({position}), 1, false);
      ADD_FAILURE() << "ranged at " << position;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::out_of_bounds);
      EXPECT_NE(std::string(error.what()).find("calibrate over a wider range"), std::string::npos);
    }
    EXPECT_GT(range_from_peaks(calibration, peaks_at({position}), 1, true).mm, 0);
  }
}

TEST(Range, NeedsAPosition) { EXPECT_THROW(range_from_peaks(curve(1), {}, 1, false), Error); }

}  // namespace
}  // namespace fathom
