// SPDX-License-Identifier: Apache-2.0
// How far a calibration may be trusted: scatter, sigmas, prediction intervals. Simulated truth
// decides.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calibration/calibration.hpp"
#include "focus/distributions.hpp"
#include "tests/unit/calibration/truth.hpp"

namespace fathom {
namespace {

using namespace test;

// The two-sided 95 %, 99 % columns of any printed table of t.
TEST(StudentT, IsThatOfThePrintedTables) {
  EXPECT_NEAR(student_t_within(0.95, 1), 12.706, 5e-4);
  EXPECT_NEAR(student_t_within(0.95, 2), 4.303, 5e-4);
  EXPECT_NEAR(student_t_within(0.95, 6), 2.447, 5e-4);
  EXPECT_NEAR(student_t_within(0.95, 30), 2.042, 5e-4);
  EXPECT_NEAR(student_t_within(0.99, 5), 4.032, 5e-4);
  EXPECT_NEAR(student_t_within(0.6827, 1e6), 1.0, 1e-3);
  // Closed form for one degree of freedom: tan(pi / 2 x probability).
  EXPECT_NEAR(student_t_within(0.999, 1), std::tan(0.999 * std::acos(0.0)), 1e-7);
}

TEST(CalibrationSigma, LearnsTheScatterOfAPosition) {
  const auto fit =
      Calibration::fit(CalibrationModel::inverse, points_of(thesis_rig, 400, 2, 3), {});
  EXPECT_NEAR(fit.position_scatter(), 2, 0.2);
}

// An honest sigma: over many calibrations, errors divided by their sigma scatter by 1.
TEST(CalibrationSigma, IsHonest) {
  std::mt19937 random(17);
  std::normal_distribution<double> error(0, 2);
  std::uniform_real_distribution<double> anywhere(1420, 2550);
  for (const auto& [model, truth, parameters] : true_models()) {
    double squares = 0, of_parameter = 0;
    constexpr int trials = 300;
    for (unsigned i = 0; i < trials; ++i) {
      const auto fit = Calibration::fit(model, points_of(truth, 30, 2, i), {});
      const double distance = anywhere(random);
      const Distance d = fit.distance(truth(distance) + error(random), fit.position_scatter());
      squares += std::pow((d.mm - distance) / d.sigma_mm, 2);
      const CalibrationParameter p = fit.parameters().front();
      of_parameter += std::pow((p.value - parameters.front()) / p.sigma, 2);
    }
    EXPECT_NEAR(std::sqrt(squares / trials), 1, 0.15) << to_string(model);
    EXPECT_NEAR(std::sqrt(of_parameter / trials), 1, 0.15) << to_string(model);
  }
}

TEST(CalibrationInterval, HoldsWhatItPromises) {
  std::mt19937 random(29);
  std::normal_distribution<double> error(0, 2);
  std::uniform_real_distribution<double> anywhere(1400, 2600);
  for (const auto& [model, truth, parameters] : true_models()) {
    int held = 0, half_held = 0;
    constexpr int trials = 2000;
    for (unsigned i = 0; i < trials; ++i) {
      const auto fit = Calibration::fit(model, points_of(truth, 8, 2, i), {});
      const double distance = anywhere(random), position = truth(distance) + error(random);
      const auto within = [&](const DistanceInterval& interval) {
        return interval.low_mm <= distance && distance <= interval.high_mm;
      };
      held += within(fit.interval(position)) ? 1 : 0;
      half_held += within(fit.interval(position, 0.5)) ? 1 : 0;
    }
    EXPECT_GT(held, 0.93 * trials) << to_string(model);
    EXPECT_LT(held, 0.97 * trials) << to_string(model);
    EXPECT_NEAR(half_held, 0.5 * trials, 0.03 * trials) << to_string(model);
    std::printf("%s: 95 %% interval holds %.2f %%, 50 %% interval %.2f %%\n", to_string(model),
                100.0 * held / trials, 100.0 * half_held / trials);
  }
}

TEST(CalibrationInterval, IsLongerOnTheFarSide) {
  for (const auto& truth : {Truth(offset_rig), Truth(reversed_rig)}) {
    const auto fit = Calibration::fit(CalibrationModel::thin_lens, points_of(truth, 8, 2, 3), {});
    const double position = truth(2500), mm = fit.distance_mm(position);
    const DistanceInterval interval = fit.interval(position);
    EXPECT_LT(interval.low_mm, mm);
    EXPECT_GT(interval.high_mm - mm, 1.001 * (mm - interval.low_mm));
    EXPECT_EQ(fit.interval(truth(1e7)).high_mm, std::numeric_limits<double>::infinity());
    EXPECT_GT(fit.interval(truth(1e7)).low_mm, 2600);
  }
}

TEST(CalibrationInterval, KnowsNothingWithoutPointsToSpare) {
  const auto fit = Calibration::fit(CalibrationModel::inverse, points_of(thesis_rig, 2), {});
  EXPECT_EQ(fit.freedom(), 0);
  EXPECT_EQ(fit.position_scatter(), 0);
  EXPECT_TRUE(std::isnan(fit.parameters()[0].sigma));
  EXPECT_EQ(fit.interval(700).low_mm, 0);
  EXPECT_EQ(fit.interval(700).high_mm, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace fathom
