// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/stepper/motor.hpp"

#include <gtest/gtest.h>

#include "fake_board.hpp"
#include "hal/whereabouts.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

using stepper::Motor;
using stepper::Pace;

const auto go_on = [] { return false; };

class StepperMotor : public testing::Test {
 protected:
  Motor make(stepper::Pulse pulse) { return {std::make_unique<FakeLines>(board), time, pulse}; }
  Motor make() { return make({false, true, 500'000, 200'000, 300'000}); }

  FakeTime time;
  std::shared_ptr<FakeBoard> board = std::make_shared<FakeBoard>(time);
};

TEST_F(StepperMotor, MakesOneStepPerPulseInTheRightDirection) {
  Motor motor = make();
  EXPECT_EQ(motor.run(100, Pace(25), go_on).made, 100);
  EXPECT_EQ(board->rotor, 100);
  EXPECT_EQ(motor.run(-30, Pace(25), go_on).made, -30);
  EXPECT_EQ(board->rotor, 70);
  EXPECT_EQ(board->steps, 130);
  EXPECT_EQ(motor.run(0, Pace(25), go_on).made, 0);
  EXPECT_EQ(board->steps, 130);
  EXPECT_FALSE(board->step_level) << "STEP is low at rest";
}

TEST_F(StepperMotor, PulsesAreAsWideAsTheBoardWants) {
  Motor motor = make();
  motor.run(50, Pace(900), go_on);
  std::int64_t changed_ns = 0;
  for (const Edge& edge : board->edges) {
    if (edge.wire != 'S') continue;
    if (changed_ns != 0) {
      EXPECT_GE(edge.time_ns - changed_ns, 500'000);
    }
    changed_ns = edge.time_ns;
  }
}

TEST_F(StepperMotor, TheDirectionIsSetUpBeforeAStepAndHeldAfterIt) {
  Motor motor = make();
  motor.run(3, Pace(1000), go_on);
  motor.run(-3, Pace(1000), go_on);
  motor.run(2, Pace(1000), go_on);
  int turns = 0;
  for (std::size_t i = 0; i < board->edges.size(); ++i) {
    if (board->edges[i].wire != 'D') continue;
    ++turns;
    EXPECT_GE(board->edges[i + 1].time_ns - board->edges[i].time_ns, 200'000);
    if (i < 2) continue;
    const Edge& rise = board->edges[i - 2];
    ASSERT_TRUE(rise.wire == 'S' && rise.level);
    EXPECT_GE(board->edges[i].time_ns - rise.time_ns, 300'000);
  }
  EXPECT_EQ(turns, 3);
  EXPECT_GE(board->shortest_interval_ns(), 1'000'000) << "also from one run to the next";
}

TEST_F(StepperMotor, TheDirectionIsWrittenOnceMoreAfterOpening) {
  board->direction_level = true;
  std::vector<bool> written;
  Motor motor = make();
  const std::int64_t opened_ns = time.now_ns();
  motor.run(1, Pace(1000), go_on);
  EXPECT_GE(board->edges.front().time_ns - opened_ns, 200'000) << "who knows how long it was high";
}

TEST_F(StepperMotor, OneDirectionMayBeTheOther) {
  Motor motor = make({false, false, 1000, 0, 0});
  board->stand_at(50);
  motor.run(10, Pace(25), go_on);
  EXPECT_EQ(board->rotor, 40) << "out is low on this rig";
}

TEST_F(StepperMotor, AFallingEdgeCanBeTheStep) {
  board->step_level = true;
  Motor motor = make({true, true, 1000, 0, 0});
  motor.run(4, Pace(25), go_on);
  EXPECT_TRUE(board->step_level) << "STEP is high at rest";
  int falls = 0;
  for (const Edge& edge : board->edges) falls += edge.wire == 'S' && !edge.level;
  EXPECT_EQ(falls, 4);
}

TEST_F(StepperMotor, EveryChangeCanBeAStep) {
  Motor motor = make({std::nullopt, true, 1000, 0, 0});
  motor.run(5, Pace(25), go_on);
  std::vector<Edge> steps;
  for (const Edge& edge : board->edges) {
    if (edge.wire == 'S') steps.push_back(edge);
  }
  ASSERT_EQ(steps.size(), 5U);
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_GE(steps[i].time_ns - steps[i - 1].time_ns, 40'000'000);
  }
  EXPECT_TRUE(board->step_level) << "left as it is: a change would be a step";
}

TEST_F(StepperMotor, IsNeverFasterThanItsRateHoweverLateItIsWoken) {
  Motor motor = make();
  int writes = 0;
  board->at_every_write = [&] { time.be_late_by_ns(++writes % 7 == 0 ? 300'000'000 : 40'000); };
  motor.run(200, Pace(40), go_on);
  EXPECT_EQ(board->rotor, 200);
  EXPECT_GE(board->shortest_interval_ns(), 25'000'000);
}

TEST_F(StepperMotor, KeepsItsRateOnTheAverage) {
  Motor motor = make();
  motor.run(1200, Pace(25), go_on);
  const auto times = board->step_times();
  const double rate = 1199e9 / static_cast<double>(times.back() - times.front());
  EXPECT_LE(rate, 25);
  EXPECT_GT(rate, 24.98);
}

TEST_F(StepperMotor, AMotorThatWasHeldUpBeginsItsRampAnew) {
  Motor motor = make({false, true, 1000, 0, 0});
  const Pace pace(1000, 2000, 20);
  int rises = 0;
  board->at_every_write = [&] {
    if (board->step_level && ++rises == 300) time.pass_ns(80'000'000);
  };
  motor.run(600, pace, go_on);
  const auto times = board->step_times();
  const auto interval = [&](int i) { return times[i] - times[i - 1]; };
  EXPECT_LT(interval(299), 2'000'000) << "at speed";
  EXPECT_GT(interval(300), 80'000'000) << "held up";
  EXPECT_GE(interval(301), pace.interval_ns(0));
  EXPECT_GE(interval(302), pace.interval_ns(1));
  EXPECT_EQ(board->rotor, 600);
}

TEST_F(StepperMotor, StopsAtOnceWithoutARampAndKnowsItsSteps) {
  Motor motor = make();
  const auto enough = [&] { return board->steps >= 30; };
  const Motor::Run run = motor.run(100, Pace(25), enough);
  EXPECT_TRUE(run.was_ended);
  EXPECT_EQ(run.made, 30);
  EXPECT_EQ(board->rotor, 30);
}

TEST_F(StepperMotor, StopsDownItsRampAndKnowsItsSteps) {
  Motor motor = make({false, true, 1000, 0, 0});
  const Pace pace(1000, 2000, 20);  // 250 steps to full speed
  const auto enough = [&] { return board->steps >= 300; };
  const Motor::Run run = motor.run(2000, pace, enough);
  EXPECT_TRUE(run.was_ended);
  EXPECT_EQ(run.made, board->rotor);
  EXPECT_NEAR(run.made, 550, 3);
  const auto times = board->step_times();
  EXPECT_GE(times.back() - times[times.size() - 2], pace.interval_ns(0)) << "slow at the end";
  for (std::size_t i = 302; i < times.size(); ++i) {
    EXPECT_GE(times[i] - times[i - 1] + 1000, times[i - 1] - times[i - 2]) << "ever slower " << i;
  }
}

TEST_F(StepperMotor, AWishToStopIsSeenWithinATenthOfASecond) {
  Motor motor = make();
  std::int64_t wished_ns = 0;
  const auto enough = [&] { return wished_ns != 0 && time.now_ns() >= wished_ns; };
  motor.run(1, Pace(0.01), enough);
  wished_ns = time.now_ns() + 10'000'000;
  EXPECT_EQ(motor.run(5, Pace(0.01), enough).made, 0);
  EXPECT_LE(time.now_ns() - wished_ns, 100'000'000) << "not a hundred seconds later";
}

TEST_F(StepperMotor, MakesNoStepIfItIsToldToStopBefore) {
  Motor motor = make();
  EXPECT_EQ(motor.run(100, Pace(25), [] { return true; }).made, 0);
  EXPECT_EQ(board->steps, 0);
}

TEST_F(StepperMotor, AThesisMotorFollowsAtItsRateAndStallsAboveItsLimit) {
  board->stall_rate = 40;
  Motor motor = make();
  motor.run(500, Pace(40), go_on);
  EXPECT_EQ(board->rotor, 500);
  motor.run(-500, Pace(50), go_on);
  EXPECT_GT(board->rotor, 400) << "this test can tell a stall";
}

TEST_F(StepperMotor, APulseThatWasBrokenOffTakesNoStepFromTheNextRun) {
  Motor motor = make();
  board->at_every_write = [&] {
    if (board->steps == 5 && board->step_level) throw Error(ErrorCode::device_lost, "gone");
  };
  expect_error(ErrorCode::device_lost, [&] { motor.run(10, Pace(25), go_on); });
  board->at_every_write = [] {};
  EXPECT_TRUE(board->step_level) << "in the middle of a pulse";
  EXPECT_EQ(motor.run(10, Pace(25), go_on).made, 10);
  EXPECT_EQ(board->rotor, 15);
}

TEST_F(StepperMotor, PassesOnThatThePortFails) {
  Motor motor = make();
  board->fail_at_step = 7;
  expect_error(ErrorCode::device_lost, [&] { motor.run(10, Pace(25), go_on); });
  EXPECT_EQ(board->rotor, 6);
}

}  // namespace
}  // namespace fathom::test
