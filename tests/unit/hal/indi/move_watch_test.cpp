// SPDX-License-Identifier: Apache-2.0
// What a focuser's driver says of a move, and what that comes to.
#include "hal/drivers/indi/move_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fathom::test {
namespace {

using namespace indi;

constexpr std::int64_t kRest_ns = 500;

/// A move of an absolute focuser from 2000 to 5000, and what its driver says.
class Move : public testing::Test {
 protected:
  static MoveOrder order() {
    return {.goal = 5000,
            .from = 2000,
            .steps = 0,
            .accuracy = 5,
            .before = 7,
            .rest_ns = kRest_ns,
            .now_ns = 0};
  }

  MoveWord say(State state, double place, std::int64_t now_ns = 1) {
    Property property;
    property.serial = ++serial_;
    property.state = state;
    if (state == State::busy) property.busy_serial = property.serial;
    return watch_.heed(property, place, now_ns);
  }

  std::uint64_t serial_ = 7;
  MoveWatch watch_{order()};
};

TEST_F(Move, WhatWasSaidBeforeSaysNothing) {
  Property old;
  old.serial = 7;
  old.state = State::alert;
  EXPECT_EQ(watch_.heed(old, 5000, 1), MoveWord::nothing);
}

TEST_F(Move, NearerIsProgressAndFartherIsNot) {
  EXPECT_EQ(say(State::busy, 2000), MoveWord::progress);  // it has begun
  EXPECT_EQ(say(State::busy, 2001), MoveWord::nothing);   // less than a thousandth of the way
  EXPECT_EQ(say(State::busy, 3000), MoveWord::progress);
  EXPECT_EQ(say(State::busy, 2500), MoveWord::nothing);
  EXPECT_EQ(say(State::busy, 3000), MoveWord::nothing);
  EXPECT_EQ(say(State::busy, 5000), MoveWord::progress);
  EXPECT_EQ(say(State::ok, 5000), MoveWord::arrived);
}

TEST_F(Move, GoingToAndFroIsNoProgressForEver) {
  int progress = 0;
  for (int i = 0; i < 100'000; ++i) {
    progress += say(i % 3 == 0 ? State::ok : State::busy, i % 2, i) == MoveWord::progress ? 1 : 0;
  }
  EXPECT_EQ(progress, 1);
}

TEST_F(Move, CreepingEnds) {
  int progress = 0;
  for (int i = 0; i < 3'000'000; ++i) {
    progress += say(State::busy, 2000 + i * 1e-3) == MoveWord::progress ? 1 : 0;
  }
  EXPECT_LE(progress, 1001);
}

TEST_F(Move, ANumberThatIsNoneIsNonsense) {
  EXPECT_EQ(say(State::busy, std::nan("")), MoveWord::nonsense);
  EXPECT_EQ(say(State::busy, 1e12), MoveWord::nonsense);
  EXPECT_EQ(say(State::alert, std::nan("")), MoveWord::failed);
}

TEST_F(Move, AtRestBesideTheGoalHasArrived) {
  say(State::busy, 4000);
  EXPECT_EQ(say(State::ok, 4999, 1000), MoveWord::progress);  // perhaps it still moves
  EXPECT_EQ(say(State::ok, 4999, 1000 + kRest_ns), MoveWord::arrived);
  EXPECT_TRUE(watch_.is_beside());
}

TEST_F(Move, AtRestFarFromTheGoalHasNot) {
  say(State::ok, 4990, 1000);
  EXPECT_EQ(say(State::ok, 4990, 10'000), MoveWord::nothing);
  EXPECT_TRUE(watch_.thinks_done());
  EXPECT_FALSE(watch_.is_beside());
}

/// A driver that repeats where it was, and says that it is done, before it has begun.
TEST_F(Move, AShortMoveIsNotOverBeforeItBegins) {
  MoveOrder near = order();
  near.from = 4997;
  watch_ = MoveWatch(near);
  say(State::ok, 4997, 1000);
  EXPECT_EQ(say(State::ok, 4997, 10'000), MoveWord::nothing);
  EXPECT_TRUE(watch_.is_beside());
}

TEST_F(Move, WhatDoesNotCountIsBelievedOnceItHasBeenBusy) {
  MoveOrder blind = order();
  blind.goal.reset();
  blind.steps = 300;
  watch_ = MoveWatch(blind);
  EXPECT_EQ(say(State::ok, 300, 1), MoveWord::nothing);
  EXPECT_EQ(say(State::busy, 300, 2), MoveWord::progress);
  EXPECT_EQ(say(State::busy, 100, 3), MoveWord::progress);  // what is left
  EXPECT_EQ(say(State::busy, std::nan(""), 4), MoveWord::nothing);
  Property done;
  done.serial = 20;
  done.busy_serial = 10;
  done.state = State::ok;
  EXPECT_EQ(watch_.heed(done, 0, 5), MoveWord::arrived);
}

}  // namespace
}  // namespace fathom::test
