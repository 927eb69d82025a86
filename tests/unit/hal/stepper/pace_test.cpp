// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/stepper/pace.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fathom::test {
namespace {

using stepper::Pace;

/// When each step of a move begins, s, the first at 0.
std::vector<double> step_times(const Pace& pace, int steps) {
  std::vector<double> times{0};
  int level = Pace::kAtRest;
  for (int left = steps - 1; left > 0; --left) {
    level = pace.next_level(level, left);
    times.push_back(times.back() + 1e-9 * static_cast<double>(pace.interval_ns(level)));
  }
  return times;
}

/// A body that accelerates evenly reaches the place s at this time, s.
double even_acceleration(double s, double acceleration, double start_rate) {
  return (std::sqrt(start_rate * start_rate + 2 * acceleration * s) - start_rate) / acceleration;
}

TEST(Pace, WithoutARampEveryIntervalIsTheRate) {
  const Pace pace(25);
  for (const int level : {0, 1, 1000}) EXPECT_EQ(pace.interval_ns(level), 40'000'000);
  EXPECT_EQ(pace.next_level(Pace::kAtRest, 100), 0);
  EXPECT_EQ(pace.next_level(0, 100), 0);
}

TEST(Pace, ARateIsALimitSoItsIntervalIsRoundedUp) {
  EXPECT_EQ(Pace(30).interval_ns(0), 33'333'334);
  EXPECT_EQ(Pace(3).interval_ns(0), 333'333'334);
}

TEST(Pace, ARampFollowsTheFormulaOfEvenAcceleration) {
  const double acceleration = 500, start_rate = 20, rate = 400;
  const std::vector<double> times = step_times(Pace(rate, acceleration, start_rate), 2000);
  // (400^2 - 20^2) / (2 * 500) = 159.6 steps of ramp
  for (int step = 1; step <= 159; ++step) {
    EXPECT_NEAR(times[step], even_acceleration(step, acceleration, start_rate), 1e-6) << step;
  }
  for (int step = 170; step < 1800; ++step) {
    EXPECT_NEAR(times[step + 1] - times[step], 1 / rate, 2e-9) << step;
  }
}

TEST(Pace, ATrapezoidTakesTheTimeThatMechanicsSays) {
  const double acceleration = 1000, rate = 500;
  const int steps = 5000;
  // Up and down in rate/acceleration each, and the rest of the way at full speed.
  const double ramp_s = rate / acceleration, ramp_steps = rate * rate / (2 * acceleration);
  const double total_s = 2 * ramp_s + (steps - 1 - 2 * ramp_steps) / rate;
  EXPECT_NEAR(step_times(Pace(rate, acceleration), steps).back(), total_s, 1e-3);
}

TEST(Pace, AShortMoveIsATriangle) {
  const double acceleration = 1000;
  const int steps = 101;
  const std::vector<double> times = step_times(Pace(500, acceleration), steps);
  EXPECT_NEAR(times.back(), 2 * even_acceleration(50, acceleration, 0), 1e-6);
  for (int i = 0; i + 1 < steps; ++i) {  // the same read backwards
    EXPECT_NEAR(times[i + 1] - times[i], times[steps - 1 - i] - times[steps - 2 - i], 1e-9) << i;
  }
}

TEST(Pace, MovesOfAFewStepsStayOnTheLowestLevels) {
  const Pace pace(1000, 100, 10);
  EXPECT_EQ(step_times(pace, 1).size(), 1U);
  EXPECT_NEAR(step_times(pace, 2)[1], even_acceleration(1, 100, 10), 1e-9);
  EXPECT_NEAR(step_times(pace, 3)[2], 2 * even_acceleration(1, 100, 10), 1e-9);
}

TEST(Pace, NoIntervalIsShorterThanTheRate) {
  for (const double rate : {3.0, 25.0, 333.0, 40'000.0}) {
    for (const double acceleration : {0.0, 1.0, 1e5, 1e9}) {
      const Pace pace(rate, acceleration, rate / 3);
      for (const int level : {0, 1, 5, 100, 1'000'000'000}) {
        EXPECT_GE(static_cast<double>(pace.interval_ns(level)), 1e9 / rate);
      }
    }
  }
}

TEST(Pace, AMotorComesToRestInAsManyStepsAsItHasLevels) {
  EXPECT_EQ(Pace::steps_to_rest(Pace::kAtRest), 0);
  EXPECT_EQ(Pace::steps_to_rest(0), 0) << "the lowest speed needs no ramp";
  EXPECT_EQ(Pace::steps_to_rest(5), 6) << "the step that is due, and one for each level below";
}

TEST(Pace, CanBeLimited) {
  EXPECT_EQ(Pace(100).limited_to(10).interval_ns(0), 100'000'000);
  EXPECT_EQ(Pace(100).limited_to(1000).interval_ns(0), 10'000'000);
  EXPECT_NEAR(Pace(100, 50).rate_from_rest(), 5, 1e-6) << "sqrt(50 / 2)";
}

}  // namespace
}  // namespace fathom::test
