// SPDX-License-Identifier: Apache-2.0
#include "engine/window.hpp"

#include <gtest/gtest.h>

#include <climits>
#include <regex>

#include "engine/error.hpp"
#include "engine/windowed_metric.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using test::expect_error;

TEST(Window, SidesArePowersOfTwoFrom8To512) {
  int sides = 0;
  for (int n = -1024; n <= 1024; ++n) sides += is_window_side(n);
  EXPECT_EQ(sides, 7);
  for (const int n : {8, 16, 32, 64, 128, 256, 512}) EXPECT_TRUE(is_window_side(n)) << n;
}

TEST(Window, FitsOnlyWhollyInside) {
  EXPECT_TRUE(fits({0, 0, 64}, 64, 64));
  EXPECT_TRUE(fits({192, 176, 64}, 256, 240));
  EXPECT_FALSE(fits({193, 176, 64}, 256, 240));
  EXPECT_FALSE(fits({192, 177, 64}, 256, 240));
  EXPECT_FALSE(fits({-1, 0, 64}, 256, 240));
  EXPECT_FALSE(fits({0, -1, 64}, 256, 240));
  EXPECT_FALSE(fits({0, 0, 0}, 256, 240));
  EXPECT_FALSE(fits({INT_MAX, INT_MAX, 64}, 256, 240)) << "x + n overflows";
  EXPECT_FALSE(fits({INT_MIN, INT_MIN, 64}, 256, 240));
  EXPECT_FALSE(fits({0, 0, INT_MAX}, 256, 240));
}

// Thesis T2.
TEST(Window, RefusesTheExampleOfTheThesis) {
  expect_error(ErrorCode::out_of_bounds,
               [] {
                 require_fits({200, 200, 64}, 256, 256);
               },
               {"64 x 64", "200,200", "256 x 256", "192,192,64"});
}

// A message that names a window which does not fit either would be worse than none.
TEST(Window, WhatItSuggestsFits) {
  const std::regex suggested("window (-?[0-9]+,-?[0-9]+,[0-9]+) fits");
  for (const auto& [width, height] : {std::pair(256, 240), {70, 500}, {9, 8}, {4000, 100}}) {
    for (const Window& window : {Window{-5, 3, 64}, Window{1000, 1000, 8}, Window{0, 0, 512},
                                 Window{INT_MIN, INT_MAX, 128}}) {
      if (fits(window, width, height)) continue;
      try {
        require_fits(window, width, height);
        ADD_FAILURE() << to_string(window);
      } catch (const Error& error) {
        std::smatch match;
        const std::string message = error.what();
        ASSERT_TRUE(std::regex_search(message, match, suggested)) << message;
        EXPECT_NO_THROW(require_fits(parse_window(match[1].str()), width, height)) << message;
      }
    }
  }
  expect_error(ErrorCode::out_of_bounds, [] { require_fits({0, 0, 8}, 7, 100); }, {"8 x 8"});
}

TEST(Window, RefusesSidesWithoutATransform) {
  for (const int n : {0, -64, 7, 65, 1024, INT_MIN, INT_MAX}) {
    expect_error(ErrorCode::bad_argument, [&] { require_fits({0, 0, n}, 4096, 4096); });
    expect_error(ErrorCode::bad_argument, [&] { centred_window(4096, 4096, n); });
  }
}

TEST(Window, CentreIsTheMiddle) {
  EXPECT_EQ(centred_window(256, 240, 64), (Window{96, 88, 64}));
  EXPECT_EQ(centred_window(65, 64, 64), (Window{0, 0, 64}));
  expect_error(ErrorCode::out_of_bounds, [] { centred_window(256, 240, 256); }, {"256 x 240"});
}

TEST(Window, GridGoesRowByRowAndStaysInside) {
  EXPECT_EQ(window_grid(20, 18, {0, 0, 8}, 5), (std::vector<Window>{{0, 0, 8},
                                                                    {5, 0, 8},
                                                                    {10, 0, 8},
                                                                    {0, 5, 8},
                                                                    {5, 5, 8},
                                                                    {10, 5, 8},
                                                                    {0, 10, 8},
                                                                    {5, 10, 8},
                                                                    {10, 10, 8}}));
  EXPECT_EQ(window_grid(20, 18, {9, 3, 8}, 5), (std::vector<Window>{{9, 3, 8}, {9, 8, 8}}));
  EXPECT_EQ(window_grid(8, 8, {0, 0, 8}, 1), (std::vector<Window>{{0, 0, 8}}));
  EXPECT_EQ(window_grid(100, 100, {0, 0, 64}, INT_MAX).size(), 1U);
  EXPECT_EQ(window_grid(64, 64, {0, 0, 8}, 1).size(), 57U * 57U);
  expect_error(ErrorCode::bad_argument, [] { window_grid(64, 64, {0, 0, 8}, 0); });
  expect_error(ErrorCode::bad_argument, [] { window_grid(64, 64, {0, 0, 8}, -3); });
  expect_error(ErrorCode::out_of_bounds, [] { window_grid(64, 63, {0, 0, 64}, 8); });
}

TEST(WindowGrid, KnowsEveryWindowWithoutHoldingThem) {
  const WindowGrid grid(20, 18, {0, 0, 8}, 5);
  ASSERT_EQ(grid.size(), 9U);
  EXPECT_EQ(grid[0], (Window{0, 0, 8}));
  EXPECT_EQ(grid[5], (Window{10, 5, 8}));
  EXPECT_EQ(grid[8], (Window{10, 10, 8}));

  const WindowGrid vast(65536, 65536, {3, 1, 8}, 1);
  ASSERT_EQ(vast.size(), std::size_t{65526} * 65528);  // more than 32 bits count
  EXPECT_EQ(vast[vast.size() - 1], (Window{65528, 65528, 8}));
  EXPECT_EQ(vast[65526], (Window{3, 2, 8}));
}

TEST(Window, ReadsWhatItPrints) {
  EXPECT_EQ(parse_window("96,88,64"), (Window{96, 88, 64}));
  EXPECT_EQ(parse_window("-3,0,8"), (Window{-3, 0, 8}));
  EXPECT_EQ(parse_window(to_string({1, 2, 512})), (Window{1, 2, 512}));
}

TEST(Window, RefusesOtherTexts) {
  for (const char* text : {"", "1", "1,2", "1,2,", "1,2,64,", "1,2,64,5", " 1,2,64", "1, 2,64",
                           "1;2;64", "a,b,c", "1.5,2,64", "1,2,63", "99999999999,2,64", ",,"}) {
    expect_error(ErrorCode::bad_argument, [&] { parse_window(text); });
  }
}

TEST(WindowedMetric, MakesMetricAndWindowAgree) {
  const auto side = [](const char* metric, std::optional<Window> window) {
    const WindowedMetric resolved = resolve_window(metric, window, 300, 200);
    EXPECT_EQ(resolved.spec.n, resolved.window.n);
    EXPECT_TRUE(fits(resolved.window, 300, 200));
    return resolved.window;
  };
  EXPECT_EQ(side("fft", std::nullopt), (Window{118, 68, 64}));
  EXPECT_EQ(side("fft:32", std::nullopt), (Window{134, 84, 32}));
  EXPECT_EQ(side("fft", Window{1, 2, 128}), (Window{1, 2, 128}));
  EXPECT_EQ(side("fft:128", Window{1, 2, 128}), (Window{1, 2, 128}));
  expect_error(ErrorCode::bad_argument,
               [] {
                 resolve_window("fft:32", Window{0, 0, 64}, 300, 200);
               },
               {"32", "64"});
  expect_error(ErrorCode::out_of_bounds, [] {
    resolve_window("fft", Window{290, 0, 64}, 300, 200);
  });
  expect_error(ErrorCode::out_of_bounds, [] { resolve_window("fft:256", std::nullopt, 300, 200); });
}

}  // namespace
}  // namespace fathom
