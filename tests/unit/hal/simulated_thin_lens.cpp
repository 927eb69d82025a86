// SPDX-License-Identifier: Apache-2.0
// The rig's optics against the figures of the thesis ("The thesis rig, for the simulator").
#include <gtest/gtest.h>

#include <cmath>

#include "hal/drivers/simulated/thin_lens.hpp"

namespace fathom::simulated {
namespace {

TEST(SimulatedThinLens, EndsOfTheTravelAreInfinityAndFourFeet) {
  EXPECT_TRUE(std::isinf(focused_distance_mm(0)));
  EXPECT_NEAR(focused_distance_mm(1200), 1219, 1e-9);
  EXPECT_NEAR(extension_mm(1200), 135.0 * 135.0 / (1219 - 135), 1e-12);
}

TEST(SimulatedThinLens, FocusedPositionsAreTheThesisOnes) {
  EXPECT_NEAR(focused_position_steps(1500), 953, 0.5);
  EXPECT_NEAR(focused_position_steps(2500), 550, 0.5);
}

TEST(SimulatedThinLens, PositionAndDistanceAreInverse) {
  for (double distance_mm = 1219; distance_mm < 10000; distance_mm *= 1.1) {
    EXPECT_NEAR(focused_distance_mm(focused_position_steps(distance_mm)), distance_mm, 1e-8);
  }
}

TEST(SimulatedThinLens, FocusObeysTheThinLensFormula) {
  for (const double position : {100.0, 550.0, 1200.0}) {
    const double image_mm = kFocalLengthMm + extension_mm(position);
    EXPECT_NEAR(1 / image_mm + 1 / focused_distance_mm(position), 1 / kFocalLengthMm, 1e-15);
  }
}

TEST(SimulatedThinLens, OneStepIsTheThesisDistance) {
  EXPECT_NEAR(focused_distance_mm(952.5) - focused_distance_mm(953.5), 1.4, 0.05);
  EXPECT_NEAR(focused_distance_mm(549.5) - focused_distance_mm(550.5), 4.3, 0.05);
}

TEST(SimulatedThinLens, OneStepBlursByThreeMicrometresEitherWay) {
  for (const double distance_mm : {1500.0, 2500.0}) {
    const double focus = focused_position_steps(distance_mm);
    EXPECT_NEAR(disc_of_confusion_mm(focus, distance_mm, 4), 0, 1e-12);
    EXPECT_NEAR(disc_of_confusion_mm(focus + 1, distance_mm, 4), 0.0032, 0.0002);
    EXPECT_NEAR(disc_of_confusion_mm(focus - 1, distance_mm, 4), 0.0032, 0.0002);
  }
}

TEST(SimulatedThinLens, HalfTheApertureHalvesTheBlur) {
  EXPECT_NEAR(disc_of_confusion_mm(700, 1500, 8), disc_of_confusion_mm(700, 1500, 4) / 2, 1e-12);
}

TEST(SimulatedThinLens, APixelOnTheObjectIsTheThesisSize) {
  EXPECT_NEAR(kPitchMm / magnification(1500), 0.40, 0.005);
  EXPECT_NEAR(kPitchMm / magnification(2500), 0.70, 0.005);
}

}  // namespace
}  // namespace fathom::simulated
