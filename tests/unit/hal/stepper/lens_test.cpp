// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "engine/file.hpp"
#include "fake_board.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

TEST(StepperLens, SaysWhatItIs) {
  FakeRig rig(Keys{{"coarse", "100"}, {"highest", "1000"}, {"lowest", "-5"}});
  const LensInfo info = rig.open()->info();
  EXPECT_EQ(info.description, "stepper motor on fake port");
  EXPECT_EQ(info.unit, "steps");
  EXPECT_EQ(info.lowest, -5);
  EXPECT_EQ(info.highest, 1000);
  EXPECT_EQ(info.resolution, 1);
  EXPECT_EQ(info.coarse_spacing, 100);
}

TEST(StepperLens, MovesAndTheNextRunKnowsWhereItStands) {
  FakeRig rig;
  {
    const auto lens = rig.open_at(0);
    EXPECT_EQ(lens->move_to(700).position, 700);
    EXPECT_EQ(lens->move_to(250.4).position, 250);
    EXPECT_EQ(rig.board->lens, 250);
  }
  EXPECT_EQ(rig.open()->position(), 250);
}

TEST(StepperLens, NeitherMovesNorTellsWhereItStandsUntilSomebodySaysSo) {
  FakeRig rig;
  const auto lens = rig.open();
  const auto expect_unknown = [&](auto&& call) {
    expect_error(ErrorCode::unavailable, call, {"not known", "fathom rigs home RIG --at POSITION"});
  };
  expect_unknown([&] { lens->position(); });
  expect_unknown([&] { lens->move_to(100); });
  EXPECT_EQ(rig.board->steps, 0);
  lens->declare_at(1200);
  EXPECT_EQ(lens->position(), 1200);
  expect_error(ErrorCode::out_of_bounds, [&] { lens->declare_at(1201); });
  expect_error(ErrorCode::bad_argument, [&] { lens->declare_at(std::nan("")); });
  EXPECT_EQ(rig.board->steps, 0) << "declaring moves nothing";
}

TEST(StepperLens, RefusesWhatIsBeyondItsSoftStops) {
  FakeRig rig(Keys{{"lowest", "100"}, {"highest", "800"}});
  const auto lens = rig.open_at(400);
  for (const double beyond : {99.9, 800.1, -1e9, std::numeric_limits<double>::infinity()}) {
    expect_error(ErrorCode::out_of_bounds, [&] { lens->move_to(beyond); }, {"100 to 800"});
  }
  expect_error(ErrorCode::bad_argument, [&] { lens->move_to(std::nan("")); });
  EXPECT_EQ(rig.board->steps, 0);
}

TEST(StepperLens, TellsWhenItStartedStoppedAndSettled) {
  FakeRig rig(Keys{{"settle_ms", "250"}});
  const auto lens = rig.open_at(0);
  const std::int64_t before_ns = rig.time.now_ns();
  const Arrival arrival = lens->move_to(100);
  const auto times = rig.board->step_times();
  EXPECT_GE(arrival.started_ns, before_ns);
  EXPECT_LE(arrival.started_ns, times.front());
  EXPECT_GE(arrival.stopped_ns, times.back());
  EXPECT_EQ(arrival.settled_ns, arrival.stopped_ns + 250'000'000);
  EXPECT_GE(rig.time.now_ns(), arrival.settled_ns) << "it waits";
}

TEST(StepperLens, StaysWhereItIsAskedToGo) {
  FakeRig rig(Keys{{"backlash", "8"}});
  const auto lens = rig.open_at(0);
  lens->move_to(300);
  const int steps = rig.board->steps;
  const std::string state = read_file(rig.state());
  std::filesystem::remove(rig.state());
  EXPECT_EQ(lens->move_to(300).position, 300);
  EXPECT_EQ(rig.board->steps, steps);
  EXPECT_FALSE(std::filesystem::exists(rig.state())) << "nothing to write";
}

/// Moves all over the travel, stopped on the way now and then, and compares where the lens truly
/// stands each time that it is at one of a few positions.
void expect_one_position_is_one_place(FakeRig& rig, Lens& lens) {
  std::map<int, int> places;
  const LensInfo info = lens.info();
  const int lowest = static_cast<int>(info.lowest);
  const int targets[] = {lowest, lowest + 1, lowest + 3, lowest + 9, 500, 502, 1190, 1200};
  unsigned random = 7;
  for (int i = 0; i < 400; ++i) {
    random = random * 1664525 + 1013904223;
    const int to = targets[random >> 29];
    if ((random >> 20) % 5 == 0) {
      const int at_step = rig.board->steps + static_cast<int>((random >> 8) % 20);
      rig.board->at_every_write = [&rig, at_step] {
        if (rig.board->steps == at_step) ++rig.stop_requests;
      };
      try {
        lens.move_to(to);
      } catch (const Error& error) {
        ASSERT_EQ(error.code(), ErrorCode::cancelled) << error.what();
      }
      rig.board->at_every_write = [] {};
    }
    const int from = rig.board->lens;
    ASSERT_EQ(lens.move_to(to).position, to);
    const auto [place, is_new] = places.emplace(to, rig.board->lens);
    ASSERT_EQ(place->second, rig.board->lens) << "move " << i << " to " << to << " from " << from;
  }
  EXPECT_EQ(places.size(), 8U);
}

TEST(StepperLens, TakesUpThePlayOfItsGearsOverAMechanicalEnd) {
  FakeRig rig(Keys{{"backlash", "8"}, {"home_by", "stop"}});
  rig.board->play = 6;
  const auto lens = rig.open_at(700);
  lens->home();
  expect_one_position_is_one_place(rig, *lens);
  EXPECT_EQ(rig.board->lens, rig.board->rotor) << "it came from below";
}

TEST(StepperLens, TakesUpThePlayBelowItsLowestPositionWhereThereIsRoom) {
  for (const char* way : {"stop", "switch"}) {
    FakeRig rig(
        Keys{{"backlash", "8"}, {"home_position", "-8"}, {"home_by", way}, {"home", "ack"}});
    rig.board->play = 6;
    rig.board->has_switch = true;
    rig.board->switch_at = 30;
    rig.board->top = 1300;
    const auto lens = rig.open_at(700);
    lens->home();
    expect_one_position_is_one_place(rig, *lens);
    lens->move_to(0);
    const int play_taken = rig.board->rotor;
    EXPECT_EQ(rig.board->lens, play_taken) << "also at the lowest position";
  }
}

TEST(StepperLens, ADeclaredPositionIsApproachedBeforeItIsBelieved) {
  FakeRig rig(Keys{{"backlash", "8"}});
  rig.board->play = 6;
  const auto lens = rig.open_at(500);
  lens->move_to(500);
  EXPECT_EQ(rig.board->steps, 16) << "down and up again";
  EXPECT_EQ(rig.board->lens, 500);
  lens->move_to(500);
  EXPECT_EQ(rig.board->steps, 16);
}

TEST(StepperLens, AMoveThatIsCutOffAtAnyMomentIsNotBelieved) {
  FakeRig rig(Keys{{"backlash", "8"}});
  const auto lens = rig.open_at(300);
  lens->move_to(300);
  const Owner owner{rig.settings.identity("fake port"), 0, 1200, 8};
  const auto left_behind = [&] {  // what a power cut now would leave
    const auto copy = rig.folder / "copy.json";
    write_file(copy, read_file(rig.state()));
    return Whereabouts(copy, owner).standing();
  };
  EXPECT_EQ(left_behind(), (Standing{300, true}));
  int looks = 0;
  rig.board->at_every_write = [&] {
    ++looks;
    EXPECT_FALSE(left_behind()) << "at step " << rig.board->steps;
  };
  lens->move_to(290);
  EXPECT_EQ(looks, 2 + 2 * (18 + 8)) << "at every edge";
  rig.board->at_every_write = [] {};
  EXPECT_EQ(left_behind(), (Standing{290, true}));
}

TEST(StepperLens, AWishToStopEndsAMoveAndThePositionIsKnown) {
  FakeRig rig;
  {
    const auto lens = rig.open_at(0);
    rig.board->at_every_write = [&] { rig.stop_requests = rig.board->steps >= 42; };
    expect_error(ErrorCode::cancelled, [&] { lens->move_to(700); }, {"from 0 to 700", "at 42"});
    EXPECT_EQ(rig.board->lens, 42);
    EXPECT_EQ(lens->position(), 42);
    EXPECT_FALSE(rig.board->step_level);
    EXPECT_EQ(lens->move_to(50).position, 50) << "an old wish does not end a new move";
  }
  EXPECT_EQ(rig.open()->position(), 50);
}

TEST(StepperLens, AWishToStopLeavesTheRampInOrder) {
  FakeRig rig(Keys{{"limit", "1000"}, {"rate", "1000"}, {"accel", "2000"}, {"start_rate", "20"}});
  const auto lens = rig.open_at(0);
  rig.board->at_every_write = [&] { rig.stop_requests = rig.board->steps >= 300; };
  expect_error(ErrorCode::cancelled, [&] { lens->move_to(1200); });
  EXPECT_EQ(lens->position(), rig.board->lens);
  EXPECT_NEAR(lens->position(), 550, 3) << "as long a way down as up";
}

TEST(StepperLens, AWishToStopEndsTheSettling) {
  FakeRig rig(Keys{{"settle_ms", "60000"}});
  const auto lens = rig.open_at(0);
  rig.board->at_every_write = [&] { rig.stop_requests = rig.board->steps == 10; };
  const std::int64_t begun_ns = rig.time.now_ns();
  expect_error(ErrorCode::cancelled, [&] { lens->move_to(10); });
  EXPECT_LT(rig.time.now_ns() - begun_ns, 2'000'000'000);
  EXPECT_EQ(lens->position(), 10);
}

TEST(StepperLens, AWishToStopDuringTheApproachLeavesItBelowAndItIsStillOneMotor) {
  FakeRig rig(Keys{{"backlash", "8"}, {"home_by", "stop"}, {"home_position", "-8"}});
  rig.board->top = 1300;
  const auto lens = rig.open_at(0);
  lens->home();
  lens->move_to(20);
  const int steps = rig.board->steps;
  rig.board->at_every_write = [&] { rig.stop_requests = rig.board->steps >= steps + 25; };
  expect_error(ErrorCode::cancelled, [&] { lens->move_to(0); }, {"at -5"});
  EXPECT_EQ(lens->position(), -5) << "below lowest, and it says so";
  rig.board->at_every_write = [] {};
  EXPECT_EQ(lens->move_to(0).position, 0);
}

TEST(StepperLens, APortThatFailsOnTheWayLeavesThePositionUnknown) {
  FakeRig rig;
  {
    const auto lens = rig.open_at(0);
    rig.board->fail_at_step = 42;
    expect_error(ErrorCode::device_lost, [&] { lens->move_to(700); }, {"port is gone"});
    rig.board->fail_at_step = 0;
    expect_error(ErrorCode::unavailable, [&] { lens->position(); }, {"moving from 0 to 700"});
    expect_error(ErrorCode::unavailable, [&] { lens->move_to(10); }, {"moving from 0 to 700"});
  }
  const auto next = rig.open();
  expect_error(ErrorCode::unavailable, [&] { next->position(); },
               {"cut off while moving from 0 to 700", rig.state().c_str()});
}

TEST(StepperLens, DoesNotMoveWhereItCannotSayThatItMoves) {
  FakeRig rig;
  const auto lens = rig.open_at(0);
  std::filesystem::remove(rig.state());
  std::filesystem::create_directories(rig.state());
  expect_error(ErrorCode::io, [&] { lens->move_to(700); });
  EXPECT_EQ(rig.board->steps, 0);
  EXPECT_EQ(lens->position(), 0);
}

TEST(StepperLens, BelongsToOneProgram) {
  FakeRig rig;
  const auto lens = rig.open();
  expect_error(ErrorCode::unavailable, [&] { rig.open(); }, {"in use by process"});
}

TEST(StepperLens, OfAnotherTravelIsUnknown) {
  FakeRig rig;
  rig.open_at(300);
  rig.settings.highest = 1100;
  expect_error(ErrorCode::unavailable, [&] { rig.open()->position(); },
               {"another motor or travel"});
}

TEST(StepperLens, LostStepsAreNotSeen) {  // and the test's board can lose them
  FakeRig rig;
  const auto lens = rig.open_at(0);
  rig.board->to_lose = 12;
  EXPECT_EQ(lens->move_to(700).position, 700);
  EXPECT_EQ(rig.board->lens, 688);
}

}  // namespace
}  // namespace fathom::test
