// SPDX-License-Identifier: Apache-2.0
#include "serve/bodies.hpp"

#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

namespace fathom::serve {
namespace {

using test::expect_error;

TEST(Bodies, WindowsAreReadAndOddOnesRefused) {
  const auto windows = windows_from(R"({"windows":[{"x":1,"y":2,"n":64},{"x":3,"y":4,"n":8}]})");
  EXPECT_EQ(windows, (std::vector<Window>{{1, 2, 64}, {3, 4, 8}}));
  for (const char* body :
       {"", "[]", "{", "null", R"({"windows":{}})", R"({"windows":[]})", R"({"windows":[1]})",
        R"({"windows":[{"x":1,"y":2}]})", R"({"windows":[{"x":1.5,"y":2,"n":64}]})",
        R"({"windows":[{"x":"1","y":2,"n":64}]})", R"({"windows":[{"x":1e99,"y":2,"n":64}]})",
        R"({"windows":[{"x":1,"y":2,"n":64,"z":0}]})",
        R"({"windows":[{"x":1,"y":2,"n":64}],"a":1})"})
    expect_error(ErrorCode::bad_argument, [&] { windows_from(body); });
}

TEST(Bodies, ALensIsSentToAPlaceOrByAWay) {
  EXPECT_EQ(lens_wish_from(R"({"position":7})").position, 7);
  EXPECT_EQ(lens_wish_from(R"({"by":-1.5})").by, -1.5);
  for (const char* body : {"{}", R"({"position":1,"by":2})", R"({"position":"1"})",
                           R"({"position":null})", R"({"position":1e999})"})
    expect_error(ErrorCode::bad_argument, [&] { lens_wish_from(body); });
}

TEST(Bodies, EveryOrderTakesItsOwnMembersAlone) {
  const Order sweep = order_from(Activity::sweep, R"({"from":1,"to":5,"step":0.5})");
  EXPECT_EQ(sweep.from, 1);
  EXPECT_EQ(sweep.to, 5);
  EXPECT_EQ(sweep.step, 0.5);
  EXPECT_FALSE(order_from(Activity::focus, "").from);
  EXPECT_EQ(order_from(Activity::range, R"({"calibration":"desk"})").calibration, "desk");
  EXPECT_EQ(order_from(Activity::calibrate, R"({"model":"auto"})").model, "auto");
  EXPECT_EQ(order_from(Activity::aim, "").window, "auto");
  EXPECT_EQ(order_from(Activity::aim, R"({"window":"nearest","to":9})").window, "nearest");
  expect_error(ErrorCode::bad_argument, [] { order_from(Activity::aim, R"({"window":"other"})"); },
               {"auto or nearest"});
  EXPECT_EQ(order_from(Activity::capture, R"({"frames":3})").frames, 3);
  expect_error(ErrorCode::bad_argument, [] { order_from(Activity::focus, R"({"step":1})"); },
               {"\"step\" is not known", "from, to"});
  expect_error(ErrorCode::bad_argument, [] { order_from(Activity::sweep, R"({"step":0})"); });
  expect_error(ErrorCode::bad_argument, [] { order_from(Activity::range, "{}"); }, {"calibration"});
  expect_error(ErrorCode::bad_argument, [] { order_from(Activity::live, "{}"); });
}

TEST(Bodies, StepsActionsAndMethodsAreChecked) {
  EXPECT_EQ(next_step_from(R"({"distance":1400})").distance_mm, 1400);
  for (const char* body : {"{}", R"({"distance":0})", R"({"distance":-1})", R"({"distance":"1"})"})
    expect_error(ErrorCode::bad_argument, [&] { next_step_from(body); });
  EXPECT_EQ(action_from(R"({"action":"take"})"), "take");
  expect_error(ErrorCode::bad_argument, [] { action_from(R"({"action":"steal"})"); }, {"refuse"});
  EXPECT_EQ(method_wish_from(R"({"metric":"fft"})").metric, "fft");
  expect_error(ErrorCode::bad_argument, [] { method_wish_from("{}"); });
  expect_error(ErrorCode::bad_argument,
               [] { method_wish_from(R"({"metric":")" + std::string(300, 'a') + R"("})"); });
  expect_error(ErrorCode::bad_argument, [] { nothing_from(R"({"a":1})"); });
}

TEST(Bodies, DeepNestingIsRefusedAsAnythingElse) {
  expect_error(ErrorCode::bad_argument, [] { nothing_from(std::string(60000, '[')); });
  expect_error(ErrorCode::bad_argument, [] {
    nothing_from("{\"a\":" + std::string(30000, '[') + std::string(30000, ']') + "}");
  });
}

TEST(Bodies, QueriesAreNumbersWithinLimits) {
  EXPECT_EQ(number_from("fps", "", 30, 0.1, 100), 30);
  EXPECT_EQ(number_from("fps", "2.5", 30, 0.1, 100), 2.5);
  for (const char* text : {"0", "101", "nan", "inf", "1x", " 1", "-5"})
    expect_error(ErrorCode::bad_argument, [&] { number_from("fps", text, 30, 0.1, 100); }, {"fps"});
}

}  // namespace
}  // namespace fathom::serve
