// SPDX-License-Identifier: Apache-2.0
#include "focus/slip.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fathom {
namespace {

/// A scene of 16 x 16 cells of a few waves, of which the shorter ones fade first as the lens goes away.
class Scene {
 public:
  /// noise: of a cell, in grey values of its mean; contrast: of the waves.
  Scene(unsigned seed, double noise, double contrast)
      : random_(seed), noise_(0, noise), contrast_(contrast) {}

  Evaluation at(double said, double really, double light = 1) {
    Evaluation evaluation{.position = said};
    for (int i = 0; i < 256; ++i) {
      double grey = 100;
      for (int wave = 1; wave <= 3; ++wave) {
        const double phase = 2 * M_PI * wave * (i % 16 + 2 * (i / 16)) / 32 + wave;
        grey += contrast_ * std::cos(phase) * std::exp(-std::pow(wave * really / 1000, 2));
      }
      const double sum = 256 * light * (grey + noise_(random_));
      evaluation.picture.cells.push_back(static_cast<std::uint32_t>(std::lround(sum)));
    }
    return evaluation;
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> noise_;
  double contrast_;
};

TEST(Slip, TellsHowFarOffALensStands) {
  Scene scene(1, 0.06, 10);
  const Evaluation first = scene.at(400, 400), other = scene.at(340, 340);
  for (const double really : {380.0, 388.0, 412.0, 430.0}) {
    const auto slip = slip_of(first, other, scene.at(400, really));
    ASSERT_TRUE(slip);
    EXPECT_NEAR(slip->part * -60, really - 400, 4) << really;
    EXPECT_GT(slip->evidence, 20) << really;
    EXPECT_TRUE(is_slipped(first, {&other, 1}, scene.at(400, really))) << really;
  }
}

TEST(Slip, IsNoneInLightThatChanges) {
  Scene scene(2, 0.06, 10);
  const Evaluation first = scene.at(400, 400), other = scene.at(340, 340, 1.1);
  EXPECT_FALSE(is_slipped(first, {&other, 1}, scene.at(400, 400, 0.8)));
}

TEST(Slip, IsRarelySeenWhereThereIsNone) {
  int seen = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    // From a change that drowns in the noise to one that is clear.
    Scene scene(seed, 0.06, 0.01 * std::pow(2, seed % 12));
    const Evaluation first = scene.at(400, 400);
    const Evaluation others[] = {scene.at(340, 340), scene.at(100, 100)};
    seen += is_slipped(first, others, scene.at(400, 400));
  }
  EXPECT_LE(seen, 1);
}

TEST(Slip, KnowsNothingWhereNothingChanges) {
  Scene scene(3, 0.06, 0);
  EXPECT_FALSE(slip_of(scene.at(400, 400), scene.at(340, 340), scene.at(400, 300)));
}

TEST(Slip, KnowsNothingWithoutCells) {
  Scene scene(4, 0.06, 10);
  const Evaluation first = scene.at(400, 400), other = scene.at(340, 340);
  EXPECT_FALSE(slip_of(first, other, {.position = 400}));
  EXPECT_FALSE(slip_of({.position = 400}, {.position = 340}, {.position = 400}));
  Evaluation dark = scene.at(400, 400);
  std::fill(dark.picture.cells.begin(), dark.picture.cells.end(), 0);
  EXPECT_FALSE(slip_of(first, other, dark));
}

}  // namespace
}  // namespace fathom
