// SPDX-License-Identifier: Apache-2.0
#include "hal/lens.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/error.hpp"

namespace fathom {
namespace {

const LensInfo kSteps{"", "steps", 0, 1200, 1, 100, {}};
const LensInfo kThirds{"", "um", -0.3, 0.9, 0.3, 0.3, {}};
const LensInfo kUneven{"", "frames", 0, 50, 1, 1, {0, 1, 7.5, 50}};

TEST(NearestPosition, RoundsToTheResolution) {
  EXPECT_EQ(nearest_position(kSteps, 10.4), 10);
  EXPECT_EQ(nearest_position(kSteps, 10.6), 11);
  EXPECT_NEAR(nearest_position(kThirds, 0.4), 0.3, 1e-12);
  EXPECT_NEAR(nearest_position(kThirds, 0.5), 0.6, 1e-12);
}

TEST(NearestPosition, TakesTheLowerOfTwoEquallyNear) {
  EXPECT_EQ(nearest_position(kSteps, 10.5), 10);
  EXPECT_EQ(nearest_position(kUneven, 0.5), 0);
}

TEST(NearestPosition, TakesOnlyTheStopsThatThereAre) {
  EXPECT_EQ(nearest_position(kUneven, 4.2), 1);
  EXPECT_EQ(nearest_position(kUneven, 4.3), 7.5);
  EXPECT_EQ(nearest_position(kUneven, 7.5), 7.5);
  EXPECT_EQ(nearest_position(kUneven, 40), 50);
}

TEST(NearestPosition, StaysWithinTheTravel) {
  for (const LensInfo& lens : {kSteps, kThirds, kUneven}) {
    EXPECT_EQ(nearest_position(lens, -1e9), lens.lowest);
    EXPECT_EQ(nearest_position(lens, 1e9), lens.highest);
  }
}

TEST(RequireWithin, RefusesWhatIsBeyondOrNoNumber) {
  EXPECT_NO_THROW(require_within(kSteps, 0));
  EXPECT_NO_THROW(require_within(kSteps, 1200));
  EXPECT_THROW(require_within(kSteps, 1200.001), Error);
  EXPECT_THROW(require_within(kSteps, -1), Error);
  EXPECT_THROW(require_within(kSteps, std::nan("")), Error);
  EXPECT_THROW(require_within(kSteps, std::numeric_limits<double>::infinity()), Error);
}

}  // namespace
}  // namespace fathom
