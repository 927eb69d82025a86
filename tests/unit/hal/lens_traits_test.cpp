// SPDX-License-Identifier: Apache-2.0
#include "hal/lens_traits.hpp"

#include <gtest/gtest.h>

#include "hal/clock.hpp"
#include "hal/stop.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using test::expect_error;

RigSettings settings(std::map<std::string, std::string> values) {
  return RigSettings("rig.toml [lens]", std::move(values));
}

LensInfo travel(double lowest, double highest) {
  LensInfo info;
  info.lowest = lowest;
  info.highest = highest;
  info.resolution = 2;
  return info;
}

TEST(LensTraits, AreTheUsualOnesUnlessTheFileSaysOtherwise) {
  const LensTraits usual{.settle_ms = 300,
                         .backlash = 4,
                         .coarse_spacing = 0,
                         .blur_px = std::nullopt,
                         .optics = std::nullopt};
  const LensTraits same = LensTraits::read(settings({}), usual);
  EXPECT_EQ(same.settle_ms, 300);
  EXPECT_EQ(same.backlash, 4);
  EXPECT_EQ(same.settle_ns(), 300'000'000);
  const LensTraits own = LensTraits::read(
      settings({{"settle_ms", "12.5"}, {"backlash", "0"}, {"coarse", "40"}}), usual);
  EXPECT_EQ(own.settle_ns(), 12'500'000);
  EXPECT_EQ(own.backlash, 0);
  EXPECT_EQ(own.coarse_spacing, 40);
}

TEST(LensTraits, KnowEveryKeySoThatMistypedOnesAreFound) {
  const RigSettings all = settings({{"settle_ms", "1"},
                                    {"backlash", "1"},
                                    {"coarse", "1"},
                                    {"focal_mm", "50"},
                                    {"f_number", "2"},
                                    {"circle_um", "5"}});
  const LensTraits traits = LensTraits::read(all, {});
  EXPECT_NO_THROW(all.require_all_used());
  ASSERT_TRUE(traits.optics);
  EXPECT_EQ(traits.optics->circle_mm, 0.005);
}

TEST(LensTraits, RefuseWhatIsHalfSaidOrHasNoMeaning) {
  expect_error(ErrorCode::bad_argument,
               [] {
                 LensTraits::read(settings({{"focal_mm", "50"}}), {});
               },
               {"focal_mm, f_number and circle_um", "rig.toml [lens]"});
  for (const char* key : {"settle_ms", "backlash", "coarse"}) {
    expect_error(ErrorCode::bad_argument,
                 [&] {
                   LensTraits::read(settings({{key, "-1"}}), {});
                 },
                 {key});
  }
}

TEST(LensTraits, GiveASpacingThatTheLensCanMake) {
  LensTraits traits;
  LensInfo info = travel(0, 100);
  traits.describe(info);
  EXPECT_EQ(info.coarse_spacing, 0) << "nobody knows";
  traits.coarse_spacing = 1;
  traits.describe(info);
  EXPECT_EQ(info.coarse_spacing, 2) << "no less than the resolution";
  traits.coarse_spacing = 1000;
  traits.describe(info);
  EXPECT_EQ(info.coarse_spacing, 100) << "no more than the travel";
}

TEST(StopWatch, SeesOnlyRequestsThatComeAfterIt) {
  int requests = 1;
  const StopRequests count = [&] { return requests; };
  const StopWatch watch(count);
  EXPECT_FALSE(watch.stopped());
  ++requests;
  EXPECT_TRUE(watch.stopped());
  EXPECT_FALSE(StopWatch(count).stopped()) << "the way back may run";
}

TEST(Clock, SleepsUntilATimeAndNoLonger) {
  const std::int64_t start = monotonic_now_ns();
  sleep_until_ns(start - 1);
  sleep_until_ns(-5);
  sleep_until_ns(0);
  sleep_until_ns(start + 20'000'000);
  EXPECT_GE(monotonic_now_ns() - start, 20'000'000);
  EXPECT_LT(monotonic_now_ns() - start, 5'000'000'000);
}

}  // namespace
}  // namespace fathom
