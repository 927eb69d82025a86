// SPDX-License-Identifier: Apache-2.0
#include "hal/step_log.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using test::expect_error;

constexpr std::int64_t kNow = 1'000'000;
const double kTurning = std::sqrt(1.0 / 3);  // a step either way

Where at(const StepLog& log, std::int64_t time_ns) { return log.during({time_ns, time_ns}, kNow); }

/// Steps in one direction, one every 100 ns, the first at `from_ns`.
void step(StepLog& log, int direction, int count, std::int64_t from_ns) {
  for (int i = 0; i < count; ++i) {
    log.make_step(direction, [&] { return from_ns + 100 * i; });
  }
}

TEST(StepLog, BeforeAndAfterTheStepsTheLensRests) {
  StepLog log(50, true, {0, 8}, 10);
  step(log, 1, 20, 1000);
  EXPECT_EQ(at(log, 500).position, 50);
  EXPECT_EQ(at(log, 500).sigma, 0);
  const Where after = log.during({2901, 5000}, kNow);
  EXPECT_EQ(after.position, 70);
  EXPECT_EQ(after.sigma, 0);
  EXPECT_EQ(after.smear, 0);
}

TEST(StepLog, AnExposureSeesTheMeanOfItsPlaces) {
  StepLog log(50, true, {0, 8}, 10);
  step(log, 1, 20, 1000);
  const Where where = log.during({950, 1250}, kNow);  // 50 ns at 50, 100 at 51 and 52, 50 at 53
  EXPECT_DOUBLE_EQ(where.position, (50 * 50 + 51 * 100 + 52 * 100 + 53 * 50) / 300.0);
  EXPECT_EQ(where.smear, 3);
  EXPECT_DOUBLE_EQ(where.sigma, kTurning);
  EXPECT_EQ(at(log, 1000).position, 51) << "from its moment on a step has been made";
  EXPECT_EQ(at(log, 999).position, 50);
}

TEST(StepLog, ThePlayThatNobodyKnowsIsUncertaintyOnTheWayDown) {
  StepLog log(50, true, {0, 8}, 10);
  step(log, -1, 20, 1000);
  const Where soon = at(log, 1350);  // after 4 steps the glass is at 46 .. 50
  EXPECT_EQ(soon.position, 48);
  EXPECT_DOUBLE_EQ(soon.sigma, std::sqrt(4 * 4 / 12.0 + 1.0 / 3));
  const Where later = at(log, 2850);  // after 19 at 31 .. 39
  EXPECT_EQ(later.position, 35);
  EXPECT_DOUBLE_EQ(later.sigma, std::sqrt(8 * 8 / 12.0 + 1.0 / 3));
  EXPECT_FALSE(log.is_taken_up());
}

TEST(StepLog, GoingUpwardTakesThePlayUp) {
  StepLog log(50, true, {0, 8}, 10);
  step(log, -1, 20, 1000);
  step(log, 1, 7, 3000);
  EXPECT_FALSE(log.is_taken_up());
  step(log, 1, 1, 3700);
  EXPECT_TRUE(log.is_taken_up());
  EXPECT_EQ(at(log, 4000).position, 38);
  EXPECT_EQ(at(log, 4000).sigma, 0);
}

TEST(StepLog, PlayThatIsKnownIsNoUncertainty) {
  StepLog log(50, true, {6, 6}, 10);
  step(log, -1, 20, 1000);
  EXPECT_EQ(at(log, 1350).position, 50) << "4 steps are within the play";
  EXPECT_EQ(at(log, 2850).position, 37);
  EXPECT_DOUBLE_EQ(at(log, 2850).sigma, kTurning);
}

TEST(StepLog, AMotorThatWasNotApproachedIsAtTheLowerEndOfItsPlayOrNot) {
  StepLog log(50, false, {0, 8}, 10);
  EXPECT_EQ(at(log, 20).position, 54);
  step(log, 1, 5, 1000);
  EXPECT_EQ(at(log, 2000).position, 56.5) << "55 .. 58";
  step(log, 1, 3, 3000);
  EXPECT_TRUE(log.is_taken_up());
}

TEST(StepLog, AnEndThatTakesUpThePlayIsBelieved) {
  StepLog log(20, true, {0, 8}, 10);
  step(log, -1, 20, 1000);
  log.arrive(4000);
  EXPECT_TRUE(log.is_taken_up());
  EXPECT_EQ(at(log, 3999).position, 4);
  EXPECT_EQ(at(log, 4000).position, 0);
}

TEST(StepLog, KnowsNeitherWhatWasBeforeNorWhatWillBe) {
  StepLog log(50, true, {0, 8}, 100);
  expect_error(ErrorCode::bad_argument, [&] { at(log, 99); }, {"older", "one clock"});
  expect_error(ErrorCode::bad_argument, [&] { log.during({99, 200}, kNow); }, {"older"});
  expect_error(ErrorCode::bad_argument, [&] { log.during({200, kNow + 1}, kNow); }, {"not over"});
  EXPECT_NO_THROW(log.during({100, kNow}, kNow));
}

TEST(StepLog, AStepThatFailsEndsWhatIsKnown) {
  StepLog log(50, true, {0, 8}, 100);
  step(log, 1, 3, 1000);
  const auto fail = []() -> std::int64_t { throw Error(ErrorCode::device_lost, "gone"); };
  expect_error(ErrorCode::device_lost, [&] { log.make_step(1, fail); });
  EXPECT_EQ(log.during({950, 1200}, kNow).smear, 2);
  expect_error(ErrorCode::unavailable, [&] { at(log, 1201); }, {"motor failed"});
}

}  // namespace
}  // namespace fathom
