// SPDX-License-Identifier: Apache-2.0
#include "serve/drive.hpp"

#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

namespace fathom::serve {
namespace {

using test::expect_error;

struct HandClock final : Clock {
  double now_s = 0;
  double wall_s() const override { return now_s; }
  double processor_s() const override { return 0; }
  double calendar_s() const override { return 0; }
};

struct DriveTest : testing::Test {
  HandClock clock;
  Drive drive{clock};
};

TEST_F(DriveTest, WhoeverCommandsFirstDrives) {
  EXPECT_FALSE(drive.driver());
  EXPECT_TRUE(drive.may_command("a"));
  EXPECT_TRUE(drive.may_command("a"));
  EXPECT_FALSE(drive.may_command("b"));
  EXPECT_EQ(drive.driver(), "a");
}

TEST_F(DriveTest, ADriverWithoutPageAndCommandsIsGoneAfterAWhile) {
  drive.may_command("a");
  clock.now_s = Drive::kGone_s;
  EXPECT_FALSE(drive.may_command("b"));
  clock.now_s = Drive::kGone_s + 1;
  EXPECT_FALSE(drive.driver());
  EXPECT_TRUE(drive.may_command("b"));
}

TEST_F(DriveTest, ADriverWithAPageStaysHoweverLongItIsQuiet) {
  drive.opened("a");
  drive.opened("a");
  drive.may_command("a");
  clock.now_s = 1000;
  EXPECT_FALSE(drive.may_command("b"));
  drive.closed("a");
  clock.now_s = 2000;
  EXPECT_FALSE(drive.may_command("b"));  // one of its two pages is open still
  drive.closed("a");
  EXPECT_FALSE(drive.may_command("b"));  // it may be loading again
  clock.now_s = 2000 + Drive::kGone_s + 1;
  EXPECT_TRUE(drive.may_command("b"));
}

TEST_F(DriveTest, OneWhoAsksGetsItWhenItIsGiven) {
  drive.opened("a");
  drive.may_command("a");
  drive.ask("b");
  drive.ask("c");
  drive.ask("b");
  EXPECT_EQ(drive.asking(), (std::vector<std::string>{"b", "c"}));
  expect_error(ErrorCode::bad_argument, [&] { drive.give("b"); });
  drive.give("a");
  EXPECT_EQ(drive.driver(), "b");
  EXPECT_EQ(drive.asking(), std::vector<std::string>{"c"});
}

TEST_F(DriveTest, SilenceIsAnAnswerAndNoIsOneToo) {
  drive.opened("a");
  drive.may_command("a");
  expect_error(ErrorCode::unavailable, [&] { drive.take("b"); });
  drive.ask("b");
  clock.now_s = Drive::kAnswer_s - 1;
  expect_error(ErrorCode::unavailable, [&] { drive.take("b"); });
  drive.refuse("a");
  clock.now_s = 100;
  expect_error(ErrorCode::unavailable, [&] { drive.take("b"); });
  drive.ask("b");
  clock.now_s += Drive::kAnswer_s;
  drive.take("b");
  EXPECT_EQ(drive.driver(), "b");
}

TEST_F(DriveTest, GivenToNobodyItIsFree) {
  drive.may_command("a");
  drive.give("a");
  EXPECT_FALSE(drive.driver());
  EXPECT_TRUE(drive.may_command("b"));
}

}  // namespace
}  // namespace fathom::serve
