// SPDX-License-Identifier: Apache-2.0
// What `rigs check` measures of a lens that has play or says too early that it is there.
#include "session/backlash.hpp"

#include <gtest/gtest.h>

#include "playing_rig.hpp"
#include "session/check.hpp"

namespace fathom::test {
namespace {

const RestAfter kAtOnce = [](double) { return 0; };

std::optional<SeenHill> own_hill(Rig& rig) {
  const Aim own{rig.spec(), rig.window()};
  return find_hill(rig, {&own, 1});
}

TEST(Hill, IsSeenGoingUpwardWhateverThePlay) {
  for (const double play : {0.0, 12.0, 60.0, 95.0}) {
    const auto gears = std::make_shared<Gears>();
    gears->play = play;
    Rig rig = playing_rig(gears);
    const auto sighting = own_hill(rig);
    ASSERT_TRUE(sighting) << play;
    EXPECT_NEAR(sighting->hill.position, 500, 0.5) << play;
    EXPECT_NEAR(sighting->hill.half_width, 14, 3) << play;  // 12 sqrt(2 ln 2)
    EXPECT_TRUE(see_again(rig, sighting->hill));
    EXPECT_FALSE(see_again(
        rig, {300, sighting->hill.half_width, sighting->hill.floor, sighting->hill.height}));
  }
}

TEST(Hill, IsSeenThoughTheDriverSaysTooEarlyThatItIsThere) {
  const auto gears = std::make_shared<Gears>();
  gears->says_when = false;
  gears->units_per_s = 250;
  Rig rig = playing_rig(gears);
  const auto sighting = own_hill(rig);
  ASSERT_TRUE(sighting);
  EXPECT_NEAR(sighting->hill.position, 500, 1);
}

/// The stripes have a period of four pixels, which the lowest frequencies do not show.
TEST(Hill, IsSeenWithAnotherMetricThanTheOneThatShowsNothing) {
  const auto gears = std::make_shared<Gears>();
  Rig rig = playing_rig(gears, "fft:32:band=0-0.06");
  EXPECT_FALSE(own_hill(rig));
  const std::vector<Aim> aims = aims_to_try(rig);
  EXPECT_EQ(aims.front().metric, rig.spec());
  const auto sighting = find_hill(rig, aims);
  ASSERT_TRUE(sighting);
  EXPECT_NE(sighting->aim.metric, rig.spec());
  EXPECT_NEAR(sighting->hill.position, 500, 1);
}

TEST(Backlash, IsTheShiftBetweenTheWays) {
  for (const double play : {3.0, 12.0, 30.0, 60.0, 95.0}) {
    const auto gears = std::make_shared<Gears>();
    gears->play = play;
    Rig rig = playing_rig(gears);
    const Backlash backlash = measure_backlash(rig, own_hill(rig).value().hill, kAtOnce);
    EXPECT_NEAR(backlash.play(), play, 0.5);
    EXPECT_TRUE(backlash.is_certain());
    EXPECT_GE(backlash.suggestion(1), play - 0.5);
    EXPECT_LE(backlash.suggestion(1), play + 3);
  }
}

TEST(Backlash, OfALensWithoutPlayIsNone) {
  Rig rig = playing_rig(std::make_shared<Gears>());
  const Backlash backlash = measure_backlash(rig, own_hill(rig).value().hill, kAtOnce);
  EXPECT_NEAR(backlash.play(), 0, 0.3);
  EXPECT_EQ(backlash.suggestion(1), 0);
}

TEST(Backlash, IsTakenUpByTheSimulatedLens) {
  RigOptions options;
  options.rig = "sim:backlash=12,noise=0.5,drift=0";
  Rig rig(options);
  EXPECT_EQ(measure_backlash(rig, own_hill(rig).value().hill, kAtOnce).suggestion(1), 0);
}

TEST(Lag, OfADriverThatSaysTooEarlyThatItIsThereGrowsWithTheWay) {
  for (const double speed : {150.0, 250.0, 1000.0}) {
    const auto gears = std::make_shared<Gears>();
    gears->says_when = false;
    gears->units_per_s = speed;
    gears->play = 60;
    Rig rig = playing_rig(gears);
    const auto lag = measure_lag(rig, own_hill(rig).value().hill);
    ASSERT_TRUE(lag) << speed;
    const double whole_ms = 1000 * 1000 / speed;
    // Play hides the short moves, so that the long ones seem slower than they are.
    EXPECT_GE(lag->after(1000), 0.95 * whole_ms) << speed;
    EXPECT_LE(lag->after(1000), 1.2 * whole_ms + 100) << speed;
    EXPECT_GE(suggested_settle_ms(*lag, rig.lens().info()), 0.95 * whole_ms) << speed;
    const Backlash backlash =
        measure_backlash(rig, own_hill(rig).value().hill,
                         [&](double distance) { return lag->after(distance) + 50; });
    EXPECT_NEAR(backlash.play(), 60, 0.5) << speed;
  }
}

TEST(Lag, OfADriverThatWaitsIsNone) {
  const auto gears = std::make_shared<Gears>();
  gears->units_per_s = 250;
  Rig rig = playing_rig(gears);
  const auto lag = measure_lag(rig, own_hill(rig).value().hill);
  ASSERT_TRUE(lag);
  EXPECT_EQ(lag->per_unit_ms, 0);
  EXPECT_EQ(lag->after(1000), 0);
}

}  // namespace
}  // namespace fathom::test
