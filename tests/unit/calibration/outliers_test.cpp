// SPDX-License-Identifier: Apache-2.0
// What a bad point does to a calibration: nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "calibration/calibration.hpp"
#include "tests/unit/calibration/truth.hpp"

namespace fathom {
namespace {

using namespace test;

// Wherever it lies, also at an end, where it pulls most.
TEST(CalibrationOutliers, OneIsLeftOutWhereverItLies) {
  for (const auto& [model, truth, parameters] : true_models()) {
    for (std::size_t bad = 0; bad < 8; ++bad) {
      for (const double off : {-31.0, 31.0}) {
        auto points = points_of(truth, 8, 0.7, static_cast<unsigned>(bad));
        const auto clean = Calibration::fit(model, points, {});
        points[bad].position += off;
        const auto fit = Calibration::fit(model, points, {});
        EXPECT_TRUE(fit.left_out(bad)) << to_string(model) << " point " << bad << " off " << off;
        EXPECT_EQ(count_left_out(fit), 1) << to_string(model) << " point " << bad;
        EXPECT_NEAR(fit.distance_mm(truth(2000)), clean.distance_mm(truth(2000)), 8)
            << to_string(model);
        EXPECT_GT(fit.r_squared(), 0.9995);
        EXPECT_EQ(fit.points().size(), 8u);
      }
    }
  }
}

TEST(CalibrationOutliers, AQuarterAreLeftOut) {
  for (const auto& [model, truth, parameters] : true_models()) {
    auto points = points_of(truth, 12, 0.7, 3);
    points[1].position += 60;
    points[2].position += 70;
    points[11].distance_mm = 1500;  // A tape read wrongly.
    const auto fit = Calibration::fit(model, points, {});
    EXPECT_TRUE(fit.left_out(1) && fit.left_out(2) && fit.left_out(11)) << to_string(model);
    EXPECT_EQ(count_left_out(fit), 3) << to_string(model);
    EXPECT_NEAR(fit.distance_mm(truth(2000)), 2000, 12) << to_string(model);
  }
}

TEST(CalibrationOutliers, AWholeDistanceOfRepeatsIsLeftOut) {
  std::vector<CalibrationPoint> points;
  for (int repeat = 0; repeat < 5; ++repeat) {
    for (const auto& point : points_of(thesis_rig, 8, 1, static_cast<unsigned>(repeat))) {
      points.push_back(point);
      if (points.size() % 8 == 4) points.back().position += 40;
    }
  }
  const auto fit = Calibration::fit(CalibrationModel::inverse, points, {});
  EXPECT_EQ(count_left_out(fit), 5);
  EXPECT_NEAR(fit.distance_mm(thesis_rig(2000)), 2000, 2);
}

TEST(CalibrationOutliers, CleanPointsAreSeldomLeftOut) {
  for (const auto& [model, truth, parameters] : true_models()) {
    int rejected = 0;
    constexpr int seeds = 2000;
    for (unsigned seed = 0; seed < seeds; ++seed) {
      rejected +=
          count_left_out(Calibration::fit(model, points_of(truth, 8, 2, seed), {})) > 0 ? 1 : 0;
    }
    EXPECT_LT(rejected, 0.02 * seeds) << to_string(model);
    std::printf("%s: clean points left out in %.2f %%\n", to_string(model),
                100.0 * rejected / seeds);
  }
}

TEST(CalibrationOutliers, RoundingIsNoOutlier) {
  for (int count = 5; count <= 40; ++count) {
    for (const auto& [model, truth, parameters] : true_models()) {
      const auto exact = points_of(truth, count);
      EXPECT_EQ(count_left_out(Calibration::fit(model, exact, {})), 0) << to_string(model);
      auto whole = exact;
      for (auto& point : whole) point.position = std::round(point.position);
      EXPECT_EQ(count_left_out(Calibration::fit(model, whole, {})), 0)
          << to_string(model) << " " << count;
    }
  }
}

// A curve of another kind must show its misfit, not throw the points away that tell.
TEST(CalibrationOutliers, AWrongModelKeepsThePointsThatTell) {
  const auto fit =
      Calibration::fit(CalibrationModel::inverse, points_of(reversed_rig, 12, 0.5, 2), {});
  EXPECT_EQ(count_left_out(fit), 0);
  EXPECT_LT(fit.r_squared(), 0.95);
}

TEST(CalibrationOutliers, NoneOfTooFewPoints) {
  auto points = points_of(thesis_rig, 4);
  points[1].position += 100;
  EXPECT_EQ(count_left_out(Calibration::fit(CalibrationModel::inverse, points, {})), 0);
}

// Many points are searched by a fixed sample.
TEST(CalibrationOutliers, TheSameTwiceAndOfManyPoints) {
  auto points = points_of(offset_rig, 300, 2, 5);
  for (std::size_t i = 0; i < 60; ++i) points[i * 5].position += 90;
  const auto fit = Calibration::fit(CalibrationModel::thin_lens, points, {});
  EXPECT_NEAR(count_left_out(fit), 60, 1);
  EXPECT_EQ(Calibration::fit(CalibrationModel::thin_lens, points, {}).json(), fit.json());
}

}  // namespace
}  // namespace fathom
