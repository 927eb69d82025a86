// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "hal/rig_driver.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

const RigSettings settings("sim", {{"noise", "1.5"},
                                   {"seed", "7"},
                                   {"drift", "off"},
                                   {"target", "orange"},
                                   {"word", "abc"},
                                   {"nan", "nan"},
                                   {"inf", "inf"},
                                   {"empty", ""},
                                   {"tail", "3mm"},
                                   {"huge", "99999999999999999999"}});

TEST(RigSettings, ReadsEveryKindOfValue) {
  EXPECT_EQ(settings.number("noise", 0, 0, 10), 1.5);
  EXPECT_EQ(settings.integer("seed", 0, 0, 10), 7);
  EXPECT_FALSE(settings.flag("drift", true));
  EXPECT_EQ(settings.text("word", ""), "abc");
  const std::string_view targets[] = {"usaf", "orange"};
  EXPECT_EQ(settings.choice("target", "usaf", targets), "orange");
}

TEST(RigSettings, GivesTheFallbackForWhatIsNotThere) {
  EXPECT_EQ(settings.number("absent", 2.5, 0, 1), 2.5);
  EXPECT_EQ(settings.integer("absent", 9, 0, 1), 9);
  EXPECT_TRUE(settings.flag("absent", true));
  EXPECT_EQ(settings.text("absent", "x"), "x");
  EXPECT_EQ(settings.choice("absent", "usaf", {}), "usaf");
}

TEST(RigSettings, RefusesValuesThatAreNotOfTheKind) {
  const auto number = [](const char* key) { return [=] { settings.number(key, 0, -1e9, 1e9); }; };
  expect_error(ErrorCode::bad_argument, number("word"), {"sim: word=abc is not a number"});
  expect_error(ErrorCode::bad_argument, number("nan"));
  expect_error(ErrorCode::bad_argument, number("inf"));
  expect_error(ErrorCode::bad_argument, number("empty"));
  expect_error(ErrorCode::bad_argument, number("tail"));
  expect_error(ErrorCode::bad_argument, [] { settings.number("noise", 0, 2, 3); }, {"from 2 to 3"});
  expect_error(ErrorCode::bad_argument, [] { settings.integer("noise", 0, 0, 9); });
  expect_error(ErrorCode::bad_argument,
               [] { settings.integer("huge", 0, 0, std::numeric_limits<long long>::max()); });
  expect_error(ErrorCode::bad_argument, [] { settings.flag("word", true); }, {"on or off"});
  expect_error(ErrorCode::bad_argument,
               [] {
                 const std::string_view targets[] = {"usaf", "seedling"};
                 settings.choice("target", "usaf", targets);
               },
               {"target=orange", "usaf, seedling"});
}

TEST(RigSettings, ANanIsNeverWithinLimits) {
  const RigSettings nan("x", {{"a", "nan"}});
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  expect_error(ErrorCode::bad_argument, [&] { nan.number("a", 0, -kInfinity, kInfinity); });
}

TEST(RigSettings, AKeyThatNobodyReadIsRefused) {
  const RigSettings some("sim", {{"noise", "1"}, {"nosie", "2"}});
  some.number("noise", 0, 0, 10);
  some.number("seed", 0, 0, 10);
  expect_error(ErrorCode::bad_argument, [&] { some.require_all_used(); },
               {"no key \"nosie\"", "noise, seed"});
  some.text("nosie", "");
  EXPECT_NO_THROW(some.require_all_used());
}

}  // namespace
}  // namespace fathom::test
