// SPDX-License-Identifier: Apache-2.0
// A motor that is watched while it turns, against where the fake board says the lens truly was.
#include <gtest/gtest.h>

#include <cmath>
#include <semaphore>

#include "engine/file.hpp"
#include "fake_board.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

/// Exposures of several lengths all along a time.
std::vector<Exposure> exposures(std::int64_t from_ns, std::int64_t to_ns) {
  std::vector<Exposure> all;
  for (const std::int64_t length_ns : {0, 1, 20, 333}) {
    for (int i = 0; i < 40; ++i) {
      const std::int64_t start_ns = from_ns + (to_ns - from_ns) * i / 40;
      all.push_back({start_ns, start_ns + length_ns * kMillisecond});
    }
  }
  return all;
}

/// Holds a motion's thread at a step of the board until the test has done what it wants.
class Halt {
 public:
  Halt(FakeRig& rig, int step) : rig_(rig) {
    rig.board->at_every_write = [this, step] {
      if (rig_.board->steps != step || was_reached_) return;
      was_reached_ = true;
      reached_.release();
      go_on_.acquire();
    };
  }
  void await() { reached_.acquire(); }
  void release() { go_on_.release(); }

 private:
  FakeRig& rig_;
  bool was_reached_ = false;  // the thread's
  std::binary_semaphore reached_{0}, go_on_{0};
};

/// What a power cut now would leave.
std::optional<Standing> left_behind(const FakeRig& rig) {
  const auto copy = rig.folder / "copy.json";
  write_file(copy, read_file(rig.state()));
  const Owner owner{rig.settings.identity("fake port"), 0, 1200, rig.settings.backlash_steps()};
  return Whereabouts(copy, owner).standing();
}

const Keys kRamp{{"limit", "1000"}, {"rate", "500"}, {"accel", "2000"}, {"start_rate", "20"}};

TEST(StepperMotion, OnTheWayUpItIsWithinAStepOfTheTruth) {
  for (const Keys& keys : {Keys{}, kRamp}) {
    FakeRig rig(keys);
    const auto lens = rig.open_at(100);
    lens->move_to(100);
    const auto motion = lens->start(400);
    const Arrival arrival = motion->wait();
    rig.time.pass_ns(1000 * kMillisecond);
    double before = 100;
    for (const Exposure& exposure :
         exposures(arrival.started_ns - 100 * kMillisecond, arrival.stopped_ns)) {
      const Where where = motion->during(exposure);
      EXPECT_NEAR(where.position, rig.board->mean_lens(exposure), 0.1);
      EXPECT_LT(where.sigma, 1);
      EXPECT_NEAR(where.smear,
                  rig.board->lens_at(exposure.end_ns) - rig.board->lens_at(exposure.start_ns), 1);
      if (exposure.start_ns == exposure.end_ns) {
        EXPECT_GE(where.position, before) << "upward, and never back";
        before = where.position;
      }
    }
    EXPECT_EQ(motion->during({arrival.started_ns, arrival.settled_ns}).smear, 300);
    EXPECT_EQ(motion->at(arrival.settled_ns).position, 400);
    EXPECT_EQ(motion->at(arrival.settled_ns).sigma, 0);
  }
}

TEST(StepperMotion, OnTheWayDownThePlayIsInTheUncertainty) {
  for (const int play : {0, 3, 8}) {
    FakeRig rig(Keys{{"backlash", "8"}});
    rig.board->play = play;
    const auto lens = rig.open_at(0);
    lens->move_to(500);
    const auto motion = lens->start(200);
    const Arrival arrival = motion->wait();
    rig.time.pass_ns(1000 * kMillisecond);
    for (const Exposure& exposure : exposures(arrival.started_ns, arrival.stopped_ns)) {
      const Where where = motion->during(exposure);
      EXPECT_LE(std::abs(where.position - rig.board->mean_lens(exposure)), 1.74 * where.sigma + 0.1)
          << "within the bounds of a uniform distribution, play " << play;
      EXPECT_LT(where.sigma, 2.5);
    }
    EXPECT_EQ(motion->at(arrival.settled_ns).position, 200);
    EXPECT_EQ(rig.board->lens, 200);
  }
}

TEST(StepperMotion, ArrivesAsAMoveDoes) {
  for (const double to : {700.0, 123.4, 0.0, 500.0}) {
    FakeRig moved(Keys{{"backlash", "8"}, {"settle_ms", "250"}}),
        watched(Keys{{"backlash", "8"}, {"settle_ms", "250"}});
    const auto move = moved.open_at(500), watch = watched.open_at(500);
    move->move_to(500);
    watch->move_to(500);
    const Arrival expected = move->move_to(to);
    const auto motion = watch->start(to);
    const Arrival arrival = motion->wait();
    EXPECT_EQ(arrival.position, expected.position);
    EXPECT_EQ(arrival.started_ns, expected.started_ns);
    EXPECT_EQ(arrival.stopped_ns, expected.stopped_ns);
    EXPECT_EQ(arrival.settled_ns, expected.settled_ns);
    EXPECT_EQ(arrival.note, "");
    EXPECT_EQ(motion->arrived().value().position, expected.position) << "and again";
    EXPECT_EQ(watch->position(), expected.position);
    EXPECT_EQ(left_behind(watched), (Standing{static_cast<int>(expected.position), true}));
    EXPECT_EQ(watched.board->lens, moved.board->lens);
  }
}

TEST(StepperMotion, RefusesAtOnceWhatItCannotDo) {
  FakeRig rig(Keys{{"lowest", "100"}, {"highest", "800"}});
  {
    const auto unknown = rig.open();
    EXPECT_TRUE(unknown->can_be_watched());
    expect_error(ErrorCode::unavailable, [&] { unknown->start(300); }, {"not known"});
  }
  const auto lens = rig.open_at(400);
  const std::string state = read_file(rig.state());
  expect_error(ErrorCode::out_of_bounds, [&] { lens->start(99.9); }, {"100 to 800"});
  expect_error(ErrorCode::out_of_bounds, [&] { lens->start(801); });
  expect_error(ErrorCode::bad_argument, [&] { lens->start(std::nan("")); });
  EXPECT_EQ(read_file(rig.state()), state);
  std::filesystem::remove(rig.state());
  std::filesystem::create_directories(rig.state());
  expect_error(ErrorCode::io, [&] { lens->start(500); });
  EXPECT_EQ(rig.board->steps, 0);
  EXPECT_EQ(lens->position(), 400) << "and it is its own again";
}

TEST(StepperMotion, WhileItLivesTheLensIsItsOwn) {
  FakeRig rig(Keys{{"home_by", "stop"}});
  const auto lens = rig.open_at(0);
  const auto expect_refused = [](auto&& call) { expect_error(ErrorCode::unavailable, call); };
  Halt halt(rig, 42);
  auto motion = lens->start(100);
  halt.await();
  EXPECT_FALSE(motion->arrived());
  EXPECT_FALSE(left_behind(rig)) << "a power cut now must not leave a position";
  for (const bool is_on_the_way : {true, false}) {
    expect_refused([&] { lens->move_to(10); });
    expect_refused([&] { lens->home(); });
    expect_refused([&] { lens->declare_at(10); });
    expect_refused([&] { lens->start(10); });
    if (!is_on_the_way) break;
    expect_refused([&] { lens->position(); });
    halt.release();
    motion->wait();
  }
  EXPECT_EQ(lens->position(), 100);
  motion.reset();
  EXPECT_EQ(lens->move_to(10).position, 10);
}

TEST(StepperMotion, StopsWithinAStep) {
  FakeRig rig;
  const auto lens = rig.open_at(0);
  Halt halt(rig, 42);
  const auto motion = lens->start(700);
  halt.await();
  motion->stop();
  halt.release();
  const Arrival arrival = motion->wait();
  EXPECT_GE(arrival.position, 42);
  EXPECT_LE(arrival.position, 43);
  EXPECT_NE(arrival.note.find("stopped on the way from 0 to 700"), std::string::npos);
  EXPECT_EQ(rig.board->lens, arrival.position);
  EXPECT_EQ(lens->position(), arrival.position);
  EXPECT_EQ(left_behind(rig), (Standing{rig.board->lens, true}));
  EXPECT_EQ(motion->at(arrival.settled_ns).position, arrival.position);
  motion->stop();
  EXPECT_EQ(motion->wait().position, arrival.position);
}

TEST(StepperMotion, StopsDownItsRamp) {
  FakeRig rig(kRamp);
  const auto lens = rig.open_at(0);
  Halt halt(rig, 20);
  const auto motion = lens->start(1200);
  halt.await();
  motion->stop();
  halt.release();
  const Arrival arrival = motion->wait();
  EXPECT_NEAR(arrival.position, 40, 3) << "as many steps down the ramp as up";
  EXPECT_EQ(rig.board->lens, arrival.position);
}

TEST(StepperMotion, StoppedOnTheWayDownItTakesThePlayUpBeforeItIsBelievedAgain) {
  FakeRig rig(Keys{{"backlash", "8"}});
  rig.board->play = 6;
  const auto lens = rig.open_at(0);
  lens->move_to(300);
  Halt halt(rig, rig.board->steps + 50);
  {
    const auto motion = lens->start(100);
    halt.await();
    motion->stop();
    halt.release();
    const Arrival arrival = motion->wait();
    EXPECT_NEAR(arrival.position, 250, 1);
    const Where rest = motion->at(arrival.settled_ns);
    EXPECT_LE(std::abs(rest.position - rig.board->lens), 1.74 * rest.sigma);
  }
  EXPECT_EQ(left_behind(rig), (Standing{static_cast<int>(lens->position()), false}));
  lens->move_to(252);
  EXPECT_EQ(rig.board->lens, 252);
}

TEST(StepperMotion, DestroyedOnTheWayItLeavesATruePosition) {
  FakeRig rig(Keys{{"settle_ms", "60000"}});
  {
    const auto lens = rig.open_at(0);
    Halt halt(rig, 42);
    {
      const auto motion = lens->start(1200);
      halt.await();
      halt.release();
    }
    EXPECT_GE(lens->position(), 42);
    EXPECT_EQ(lens->position(), rig.board->lens);
    EXPECT_FALSE(rig.board->step_level);
    EXPECT_EQ(left_behind(rig), (Standing{rig.board->lens, true}));
  }
  EXPECT_EQ(rig.open()->position(), rig.board->lens);
}

TEST(StepperMotion, AWishToStopEndsItAsItEndsAMove) {
  FakeRig rig;
  const auto lens = rig.open_at(0);
  rig.board->at_every_write = [&] { rig.stop_requests = rig.board->steps >= 42; };
  const auto motion = lens->start(700);
  for (int i = 0; i < 2; ++i) {
    expect_error(ErrorCode::cancelled, [&] { motion->wait(); }, {"from 0 to 700", "at 42"});
    expect_error(ErrorCode::cancelled, [&] { motion->arrived(); });
  }
  EXPECT_EQ(lens->position(), 42);
}

TEST(StepperMotion, APortThatFailsLeavesThePositionUnknown) {
  FakeRig rig;
  const auto lens = rig.open_at(0);
  rig.board->fail_at_step = 42;
  {
    const auto motion = lens->start(700);
    expect_error(ErrorCode::device_lost, [&] { motion->wait(); }, {"port is gone"});
    expect_error(ErrorCode::device_lost, [&] { motion->arrived(); }, {"port is gone"});
    EXPECT_EQ(motion->at(rig.board->step_times()[20]).position, 21) << "what was before is known";
    expect_error(ErrorCode::unavailable, [&] { motion->at(rig.time.now_ns()); });
    expect_error(ErrorCode::unavailable, [&] { lens->position(); }, {"moving from 0 to 700"});
  }
  rig.board->fail_at_step = 0;
  expect_error(ErrorCode::unavailable, [&] { lens->start(10); }, {"moving from 0 to 700"});
  EXPECT_FALSE(left_behind(rig));
}

TEST(StepperMotion, WhereItStandsAlreadyItHasArrived) {
  FakeRig rig;
  const auto lens = rig.open_at(300);
  const std::string state = read_file(rig.state());
  const auto motion = lens->start(300.2);
  EXPECT_EQ(motion->wait().position, 300);
  EXPECT_EQ(motion->at(rig.time.now_ns()).position, 300);
  EXPECT_EQ(rig.board->steps, 0);
  EXPECT_EQ(read_file(rig.state()), state);
}

TEST(StepperMotion, KnowsOnlyWhatHasBeenSinceTheLensWasAtRest) {
  FakeRig rig;
  const auto lens = rig.open_at(0);
  lens->move_to(100);
  const std::int64_t stood_ns = rig.board->step_times().back();
  rig.time.pass_ns(50 * kMillisecond);
  const auto motion = lens->start(200);
  motion->wait();
  EXPECT_EQ(motion->at(stood_ns + 10).position, 100);
  expect_error(ErrorCode::bad_argument, [&] { motion->at(stood_ns - kMillisecond); });
  expect_error(ErrorCode::bad_argument, [&] { motion->at(rig.time.now_ns() + 1); });
  expect_error(ErrorCode::bad_argument,
               [&] {
                 motion->during({0, 20 * kMillisecond});
               },
               {"one clock"});
}

}  // namespace
}  // namespace fathom::test
