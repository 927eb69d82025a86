// SPDX-License-Identifier: Apache-2.0
// The same on the computer's own clock, for as long as it takes to see that it is obeyed.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "fake_board.hpp"
#include "hal/clock.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

struct RealRig : FakeRig {
  explicit RealRig(Keys keys) : FakeRig(std::move(keys)) {
    board = std::make_shared<FakeBoard>(stepper::monotonic_time());
  }
  std::unique_ptr<stepper::StepperLens> open() { return FakeRig::open(stepper::monotonic_time()); }
};

TEST(StepperInRealTime, IsAsFastAsItsRateAndNoFaster) {
  RealRig rig(Keys{{"limit", "500"}, {"rate", "500"}, {"settle_ms", "30"}, {"pulse_us", "200"}});
  const auto lens = rig.open();
  lens->declare_at(0);
  const Arrival arrival = lens->move_to(200);
  EXPECT_EQ(rig.board->rotor, 200);
  const auto times = rig.board->step_times();
  EXPECT_GE(rig.board->shortest_interval_ns() + 50'000, 2'000'000)
      << "the fake notes the time a little after a change, and may be late itself";
  EXPECT_GE(times.back() - times.front(), 199 * 2'000'000LL - 50'000);
  EXPECT_LT(times.back() - times.front(), 4'000'000'000) << "a busy machine may be slow, but this";
  EXPECT_GE(arrival.settled_ns, times.back() + 30'000'000);
  EXPECT_GE(monotonic_now_ns(), arrival.settled_ns);
}

/// A camera beside the motor stamps on the same clock.
TEST(StepperInRealTime, TellsWhereTheLensWasWhileACameraExposed) {
  RealRig rig(Keys{{"limit", "500"}, {"rate", "500"}});
  const auto lens = rig.open();
  lens->declare_at(0);
  const auto motion = lens->start(300);
  std::vector<Exposure> exposures;
  std::vector<Where> told;
  do {
    Exposure exposure{monotonic_now_ns(), 0};
    fathom::sleep_until_ns(exposure.start_ns + 20'000'000);
    exposure.end_ns = monotonic_now_ns();
    exposures.push_back(exposure);
    told.push_back(motion->during(exposure));  // while the motor turns
  } while (!motion->arrived());
  for (std::size_t i = 0; i < exposures.size(); ++i) {
    EXPECT_NEAR(told[i].position, rig.board->mean_lens(exposures[i]), 1) << "exposure " << i;
  }
}

/// `move` begins a move of the whole travel, 48 s, in a program of its own that is then killed.
void expect_unknown_after_kill(const std::function<void(Lens&)>& move) {
  RealRig rig(Keys{});
  rig.open()->declare_at(0);
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      move(*rig.open());
    } catch (...) {
    }
    ::_exit(1);
  }
  ASSERT_GT(child, 0);
  fathom::sleep_until_ns(monotonic_now_ns() + 400'000'000);
  ASSERT_EQ(::kill(child, SIGKILL), 0);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status)) << "it was still on its way";
  const auto lens = rig.open();  // and its lock went with it
  expect_error(ErrorCode::unavailable, [&] { lens->position(); },
               {"cut off while moving from 0 to 1200"});
}

TEST(StepperInRealTime, AProgramThatIsKilledOnTheWayLeavesAnUnknownPosition) {
  expect_unknown_after_kill([](Lens& lens) { lens.move_to(1200); });
  expect_unknown_after_kill([](Lens& lens) { lens.start(1200)->wait(); });
}

}  // namespace
}  // namespace fathom::test
