// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "fake_board.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

struct SwitchRig : FakeRig {
  explicit SwitchRig(Keys keys = {})
      : FakeRig([&] {
          keys.emplace("home", "ack");
          return keys;
        }()) {
    board->has_switch = true;
    board->switch_at = 0;
    board->top = 1300;
  }
};

TEST(StepperHoming, NeedsToBeToldHow) {
  FakeRig rig;
  const auto lens = rig.open_at(50);
  expect_error(ErrorCode::unsupported, [&] { lens->home(); },
               {"home_by = \"none\"", "fathom rigs home RIG --at POSITION"});
  EXPECT_EQ(lens->position(), 50);
  EXPECT_EQ(rig.board->steps, 0);
}

TEST(StepperHoming, AgainstTheEndMakesThePositionTrue) {
  for (const int stands : {0, 1, 700, 1200}) {
    FakeRig rig(Keys{{"home_by", "stop"}});
    rig.board->stand_at(stands);
    const auto lens = rig.open();
    const Arrival arrival = lens->home();
    EXPECT_EQ(arrival.position, 0);
    EXPECT_EQ(arrival.note, "");
    EXPECT_EQ(rig.board->lens, 0) << "from " << stands;
    EXPECT_EQ(rig.board->steps, 1200 + 60) << "the travel and a margin";
    lens->move_to(500);
    EXPECT_EQ(rig.board->lens, 500);
  }
}

TEST(StepperHoming, IsSlow) {
  FakeRig rig(Keys{{"home_by", "stop"}});
  rig.open()->home();
  EXPECT_GE(rig.board->shortest_interval_ns(), 80'000'000) << "half the rate";
  FakeRig slower(Keys{{"home_by", "stop"}, {"home_rate", "5"}, {"home_margin", "1"}});
  slower.open()->home();
  EXPECT_GE(slower.board->shortest_interval_ns(), 200'000'000);
  EXPECT_EQ(slower.board->steps, 1201);
}

TEST(StepperHoming, AgainstTheEndLeavesItForTheLowestPosition) {
  FakeRig rig(Keys{{"home_by", "stop"}, {"home_position", "-20"}, {"lowest", "10"}});
  rig.board->stand_at(300);
  const auto lens = rig.open();
  EXPECT_EQ(lens->home().position, 10);
  EXPECT_EQ(rig.board->lens, 30) << "10 is 30 steps above the end at -20";
}

TEST(StepperHoming, ToTheSwitchFindsTheSamePlaceFromEverywhere) {
  for (const int stands : {-30, -1, 0, 1, 5, 700, 1200}) {
    SwitchRig rig(Keys{{"home_by", "switch"}});
    rig.board->stand_at(100);
    rig.board->switch_at = 100;  // room below the switch
    rig.board->stand_at(100 + stands);
    const auto lens = rig.open();
    EXPECT_EQ(lens->home().position, 0);
    EXPECT_EQ(rig.board->lens, 100) << "from " << stands;
    lens->move_to(250);
    EXPECT_EQ(rig.board->lens, 350);
  }
}

TEST(StepperHoming, ToTheSwitchComesSlowlyTheSecondTime) {
  SwitchRig rig;
  rig.board->stand_at(200);
  rig.open()->home();
  const auto times = rig.board->step_times();
  EXPECT_GE(times[100] - times[99], 80'000'000);
  EXPECT_LT(times[100] - times[99], 90'000'000);
  for (std::size_t i = times.size() - 4; i < times.size(); ++i) {
    EXPECT_GE(times[i] - times[i - 1], 320'000'000) << "a quarter of that";
  }
}

TEST(StepperHoming, WithARampStandsExactlyAtTheSwitch) {
  for (const int stands : {0, 3, 400, 1200}) {
    SwitchRig rig(
        Keys{{"limit", "1000"}, {"rate", "1000"}, {"accel", "500"}, {"home_rate", "300"}});
    rig.board->switch_at = 200;
    rig.board->top = 1500;
    rig.board->stand_at(200 + stands);
    rig.open()->home();
    EXPECT_EQ(rig.board->lens, 200) << "from " << stands;
  }
}

TEST(StepperHoming, ToTheSwitchTellsLostSteps) {
  SwitchRig rig;
  const auto lens = rig.open();
  lens->home();
  rig.board->to_lose = 12;
  lens->move_to(700);  // stands at 688
  Arrival arrival = lens->home();
  EXPECT_NE(arrival.note.find("12 steps early: steps were lost"), std::string::npos)
      << arrival.note;
  lens->move_to(700);
  rig.board->to_lose = 1;
  lens->move_to(300);  // stands at 301
  arrival = lens->home();
  EXPECT_NE(arrival.note.find("1 step late: steps were lost"), std::string::npos) << arrival.note;
  lens->move_to(700);
  EXPECT_EQ(lens->home().note, "") << "and now it is right again";
}

TEST(StepperHoming, AlsoWithPlayASoundMotorHasLostNothing) {
  SwitchRig rig(Keys{{"backlash", "8"}, {"lowest", "8"}, {"home_position", "0"}});
  rig.board->play = 6;
  rig.board->switch_at = 50;
  rig.board->stand_at(400);
  const auto lens = rig.open();
  EXPECT_EQ(lens->home().note, "") << "nobody knew where it stood";
  for (const int to : {700, 8, 9, 30, 12}) {
    lens->move_to(to);
    EXPECT_EQ(lens->home().note, "") << "from " << to;
  }
}

TEST(StepperHoming, GivesUpWhereTheSwitchNeverComes) {
  SwitchRig rig;
  rig.board->switch_at = -1000;
  rig.board->stand_at(400);
  const auto lens = rig.open();
  expect_error(ErrorCode::device_lost, [&] { lens->home(); }, {"no home switch after 1260 steps"});
  EXPECT_EQ(rig.board->steps, 1260);
  expect_error(ErrorCode::unavailable, [&] { lens->position(); }, {"going home"});
}

TEST(StepperHoming, GivesUpWhereTheSwitchStaysClosed) {
  SwitchRig rig;
  rig.board->switch_at = 5000;
  const auto lens = rig.open();
  expect_error(ErrorCode::device_lost, [&] { lens->home(); }, {"stays closed for 1200 steps"});
  EXPECT_EQ(rig.board->steps, 1200);
}

TEST(StepperHoming, GivesUpWhereTheMotorDoesNotTurn) {
  SwitchRig rig;
  rig.board->is_stuck = true;
  rig.board->stand_at(400);
  const auto lens = rig.open();
  expect_error(ErrorCode::device_lost, [&] { lens->home(); }, {"whether the motor turns"});
}

TEST(StepperHoming, TheSwitchMayAnswerWithTheOtherLevel) {
  SwitchRig rig(Keys{{"home_when", "high"}});
  rig.board->switch_at = 200;  // low at or below 200: this one lets go there
  rig.board->stand_at(100);
  const auto lens = rig.open();
  expect_error(ErrorCode::device_lost, [&] { lens->home(); });
  EXPECT_EQ(rig.board->lens, 0) << "it looked for a high level downward";
}

TEST(StepperHoming, ThatIsStoppedLeavesThePositionUnknown) {
  for (const char* way : {"stop", "switch"}) {
    SwitchRig rig(Keys{{"home_by", way}});
    const auto lens = rig.open_at(400);
    rig.board->at_every_write = [&] { rig.stop_requests = rig.board->steps >= 100; };
    expect_error(ErrorCode::cancelled, [&] { lens->home(); }, {"on the way home"});
    EXPECT_EQ(rig.board->steps, 100);
    expect_error(ErrorCode::unavailable, [&] { lens->position(); }, {"going home"});
  }
}

TEST(StepperHoming, IsKnownToTheNextRun) {
  SwitchRig rig;
  rig.board->stand_at(400);
  rig.open()->home();
  EXPECT_EQ(rig.open()->position(), 0);
}

}  // namespace
}  // namespace fathom::test
