// SPDX-License-Identifier: Apache-2.0
// The C interface from C++: the same numbers as the library, and an error text for each thread.
#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <type_traits>

#include "backends/backends.hpp"
#include "capi/fathom.h"
#include "engine/error.hpp"
#include "tests/support/frames.hpp"

namespace fathom {
namespace {

TEST(CInterface, IsPlainData) {
  static_assert(std::is_standard_layout_v<fathom_window> && std::is_trivial_v<fathom_window>);
  static_assert(sizeof(fathom_window) == 3 * sizeof(int));
}

TEST(CInterface, ScoresAreThoseOfTheLibrary) {
  const Frame frame = test::make_frame("natural", 16, 90, 80, 5);
  const auto windows = window_grid(90, 80, {0, 0, 32}, 9);
  std::vector<fathom_window> c_windows;
  for (const Window& window : windows) c_windows.push_back({window.x, window.y, window.n});
  for (const char* metric : {"fft:32", "fft:32:tukey=0.25:power:band=0-0.25", "walsh-paley:32",
                             "fft:32:hann:power:rings=8"}) {
    fathom_plan* const plan = fathom_open(metric, "reference", windows.size());
    ASSERT_NE(plan, nullptr) << fathom_error_text();
    const std::size_t numbers = windows.size() * fathom_outputs(plan);
    EXPECT_EQ(fathom_outputs(plan), MetricSpec::parse(metric).outputs());
    std::vector<double> scores(numbers), expected(numbers);
    EXPECT_EQ(fathom_score(plan, frame.row(0), 90, 80, 16, frame.stride_bytes(), c_windows.data(),
                           c_windows.size(), scores.data()),
              FATHOM_OK)
        << fathom_error_text();
    const auto device = all_backends().back()->open(0, {});
    device->plan(MetricSpec::parse(metric), windows.size())->score(frame, windows, expected);
    EXPECT_EQ(scores, expected);
    EXPECT_GT(scores[0], 0);
    EXPECT_EQ(fathom_metric(plan), MetricSpec::parse(metric).text());
    fathom_close(plan);
  }
}

TEST(CInterface, NoPlanGivesNoNumbers) { EXPECT_EQ(fathom_outputs(nullptr), 0U); }

TEST(CInterface, ErrorsBelongToTheirThread) {
  EXPECT_EQ(fathom_open("no-such-transform", nullptr, 1), nullptr);
  const std::string mine = fathom_error_text();
  std::thread([] {
    EXPECT_EQ(fathom_error_status(), FATHOM_OK);
    EXPECT_STREQ(fathom_error_text(), "");
    EXPECT_EQ(fathom_open("fft:9", nullptr, 1), nullptr);
  }).join();
  EXPECT_EQ(fathom_error_text(), mine);
  EXPECT_EQ(fathom_error_status(), FATHOM_BAD_ARGUMENT);
}

TEST(CInterface, LongErrorTextsAreCutNotSpilled) {
  const std::string metric(5000, 'x');
  EXPECT_EQ(fathom_open(metric.c_str(), nullptr, 1), nullptr);
  EXPECT_EQ(std::string(fathom_error_text()).size(), 1023U);
}

TEST(CInterface, ABackendFromTheEnvironment) {
  ASSERT_EQ(setenv("FATHOM_BACKEND", "abacus", 1), 0);
  EXPECT_EQ(fathom_open("fft:8", nullptr, 1), nullptr);
  EXPECT_EQ(fathom_error_status(), FATHOM_UNAVAILABLE);
  ASSERT_EQ(setenv("FATHOM_BACKEND", "reference", 1), 0);
  fathom_plan* const plan = fathom_open("fft:8", "", 1);
  ASSERT_NE(plan, nullptr) << fathom_error_text();
  EXPECT_NE(std::string(fathom_device(plan)).find("reference:0"), std::string::npos);
  fathom_close(plan);
  unsetenv("FATHOM_BACKEND");
}

}  // namespace
}  // namespace fathom
