// SPDX-License-Identifier: Apache-2.0
#include "session/settling.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "focus/focus.hpp"

namespace fathom {
namespace {

constexpr double kInterval_ms = 30;

/// A score that swings round 100 and calms down, with a little noise that repeats.
std::vector<AfterMove> ringing(double decay_ms, double amplitude, int count) {
  std::vector<AfterMove> frames;
  for (int i = 0; i < count; ++i) {
    const double t = kInterval_ms * i - 10;
    const double noise = 0.05 * std::sin(7.3 * i);
    frames.push_back({t, 100 + amplitude * std::exp(-std::max(t, 0.0) / decay_ms) + noise});
  }
  return frames;
}

TEST(Settling, IsOverWhenTheScoreStays) {
  const Settling settling = judge_settling(ringing(60, 40, 40));
  EXPECT_TRUE(settling.is_at_rest);
  EXPECT_NEAR(settling.interval_ms, kInterval_ms, 1e-9);
  EXPECT_NEAR(settling.change, 0.4, 0.02);
  // 40 exp(-t / 60) is one percent of 100 at 60 ln 40 = 221 ms.
  EXPECT_GE(settling.settled_ms, 221);
  EXPECT_LE(settling.settled_ms, 221 + kInterval_ms);
}

TEST(Settling, TakesNoTimeWhereNothingChanges) {
  const Settling settling = judge_settling(ringing(60, 0, 20));
  EXPECT_TRUE(settling.is_at_rest);
  EXPECT_EQ(settling.settled_ms, 0);
}

TEST(Settling, OfALensStillOnItsWayIsUnknown) {
  EXPECT_FALSE(judge_settling(ringing(5000, 40, 20)).is_at_rest);
  EXPECT_FALSE(judge_settling(ringing(60, 40, kFewestFrames - 1)).is_at_rest);
}

TEST(Settling, OneOddFrameIsNoise) {
  auto frames = ringing(60, 40, 40);
  frames[20].score = 103;
  EXPECT_EQ(judge_settling(frames).settled_ms, judge_settling(ringing(60, 40, 40)).settled_ms);
}

TEST(Settling, ASecondSwingCounts) {
  auto frames = ringing(60, 40, 60);
  frames[20].score = 103;
  frames[22].score = 97;  // and between them it passed through its place
  const Settling settling = judge_settling(frames);
  EXPECT_TRUE(settling.is_at_rest);
  EXPECT_EQ(settling.settled_ms, frames[23].since_ms);
}

TEST(Settling, OfTheSimulatedLensIsWhatItSays) {
  RigOptions options;
  options.rig = "sim:noise=0.3,drift=0.3";
  Rig rig(options);
  const Settling settling = measure_settling(rig, 500, 795, 0, 800);
  EXPECT_TRUE(settling.is_at_rest);
  // The simulated lens waits until it has settled, so every frame after that is at rest.
  EXPECT_LE(settling.settled_ms, 250);
}

}  // namespace
}  // namespace fathom
