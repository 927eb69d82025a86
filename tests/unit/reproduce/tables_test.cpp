// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/tables.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>

namespace fathom::reproduce {
namespace {

TEST(ThesisTables, HaveTheThesisPoints) {
  const auto sets = thesis_tables();
  ASSERT_EQ(sets.size(), 5u);
  const int points[] = {17, 11, 21, 22, 21};  // pp. 76-88
  for (std::size_t i = 0; i < sets.size(); ++i) EXPECT_EQ(sets[i].thesis_points(), points[i]);
}

// A mistyped number would show: the means and the differences were printed side by side. The thesis
// rounded the means, so they agree to a few hundredths of a per cent.
TEST(ThesisTables, AgreeWithThemselves) {
  for (const TableSet& set : thesis_tables()) {
    for (const TableRow& row : set.rows) {
      const double percent = 100 * std::abs(row.thesis_mm - row.actual_mm) / row.actual_mm;
      EXPECT_NEAR(percent, row.thesis_percent, 0.035) << row.actual_mm << " " << row.thesis_mm;
    }
  }
}

TEST(OldCurve, FindsTheCurveThatPointsLieOn) {
  std::vector<CalibrationPoint> inverse, power;
  for (const double position : {520.0, 700.0, 900.0, 1030.0}) {
    inverse.push_back({position, 135 + 1.3008e6 / position});
    power.push_back({position, 9e5 * std::pow(position, -0.93)});
  }
  const OldCurve first = OldCurve::fit(CalibrationModel::inverse, inverse);
  EXPECT_NEAR(first.b0, 135, 1e-6);
  EXPECT_NEAR(first.b1, 1.3008e6, 1e-2);
  EXPECT_NEAR(first.r_squared, 1, 1e-12);
  const OldCurve second = OldCurve::fit(CalibrationModel::power, power);
  EXPECT_NEAR(second.b0, 9e5, 1e-3);
  EXPECT_NEAR(second.b1, -0.93, 1e-9);
  EXPECT_NEAR(second.distance_mm(700), power[1].distance_mm, 1e-6);
}

TEST(ThesisRequest, BracketsTheFocus) {
  Dice dice(1);
  for (int i = 0; i < 100; ++i) {
    const double distance = dice.between(1400, 2600);
    const FocusRequest request = thesis_request(distance, dice);
    ASSERT_TRUE(request.bracket);
    EXPECT_LT(request.bracket->low, true_position(distance) - 19);
    EXPECT_GT(request.bracket->high, true_position(distance) + 19);
    EXPECT_LT(request.bracket->low, request.bracket->inner);
    EXPECT_LT(request.bracket->inner, request.bracket->high);
  }
}

TEST(RunAll, RunsEachTaskOnceAndPassesFailuresOn) {
  std::atomic<int> runs = 0;
  std::size_t told = 0;
  run_all(Tasks(50, [&] { ++runs; }), [&](std::size_t done, std::size_t) { told = done; });
  EXPECT_EQ(runs, 50);
  EXPECT_EQ(told, 50u);
  EXPECT_THROW(run_all(Tasks(3, [] { throw std::runtime_error("x"); }), [](auto, auto) {}),
               std::runtime_error);
}

}  // namespace
}  // namespace fathom::reproduce
