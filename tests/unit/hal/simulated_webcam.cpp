// SPDX-License-Identifier: Apache-2.0
// The simulated webcam: dioptres, a picture that grows, a compression that leaves its marks.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "hal/drivers/simulated/compression.hpp"
#include "hal/drivers/simulated/objective.hpp"
#include "simulated_support.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using simulated::webcam_objective;
using test::expect_error;
using test::pixels;
using test::SimulatedRig;

TEST(SimulatedWebcam, FocusesInEqualStepsOfPower) {
  const auto& objective = webcam_objective();
  EXPECT_TRUE(std::isinf(objective.focused_distance_mm(0)));
  EXPECT_NEAR(objective.focused_distance_mm(255), 100, 1e-9);
  EXPECT_TRUE(std::isinf(objective.focused_distance_mm(12)));
  EXPECT_NEAR(objective.focused_distance_mm(51), 1000 / 1.6, 1e-9);
  EXPECT_NEAR(objective.disc_mm(51, 625, 2), 0, 1e-12);
  // 1 dioptre beside the focus, 4 mm at f/2: 2 mm x 4 mm x 0.001 / mm, on pixels of 6 um; drawn on
  // pixels of 40 um.
  EXPECT_NEAR(objective.disc_mm(255 * 1.5 / 10.5, 1e12, 2) / 0.04, 2 * 4 * 0.001 / 0.006, 0.01);
}

TEST(SimulatedWebcam, ThePictureGrowsAsItFocusesNearer) {
  const auto& objective = webcam_objective();
  // The sensor moves from 3.9920 mm to 4.1667 mm behind the lens.
  EXPECT_NEAR(objective.pixel_on_object_mm(0, 300) / objective.pixel_on_object_mm(255, 300),
              1.04375, 1e-5);
}

double sharpness(const std::vector<std::uint32_t>& seen) {
  double sum = 0;
  for (std::size_t i = 1; i < seen.size(); ++i) {
    const double step = static_cast<double>(seen[i]) - seen[i - 1];
    sum += step * step;
  }
  return sum;
}

TEST(SimulatedWebcam, IsSharpestWhereItsPowerIsThatOfTheTarget) {
  SimulatedRig rig("sim:lens=webcam,noise=0,drift=0,distance=300");
  EXPECT_EQ(rig.lens().info().unit, "units");
  EXPECT_EQ(rig.lens().info().highest, 255);
  EXPECT_EQ(rig.lens().info().coarse_spacing, 0) << "a webcam says nothing of its optics";
  int best = 0;
  double most = 0;
  for (int position = 63; position <= 123; position += 2) {
    rig.lens().move_to(position);
    const double found = sharpness(pixels(rig.grab()));
    if (found > most) most = found, best = position;
  }
  EXPECT_NEAR(best, 93, 2);
}

TEST(SimulatedWebcam, HasAStageOfArmsLengthAndNoReliefs) {
  const Hardware rig = open_hardware("sim:lens=webcam");
  EXPECT_EQ(rig.stage->distance_mm(), 300);
  EXPECT_NO_THROW(rig.stage->place_at(150));
  expect_error(ErrorCode::out_of_bounds, [&] { rig.stage->place_at(1e5); }, {"3000"});
  expect_error(ErrorCode::bad_argument, [] { open_hardware("sim:lens=webcam,target=slant"); },
               {"slant", "lens=thesis"});
  expect_error(ErrorCode::bad_argument, [] { open_hardware("sim:lens=telescope"); },
               {"telescope", "thesis, webcam"});
}

TEST(SimulatedWebcam, CompressionKeepsWhatIsCoarseAndRoundsWhatIsFine) {
  constexpr int kWidth = 24, kHeight = 16;
  std::mt19937 random(4);
  std::vector<std::uint8_t> flat(kWidth * kHeight, 97), noisy;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const auto noise = static_cast<int>(random() % 5) - 2;
    noisy.push_back(static_cast<std::uint8_t>(97 + noise));
  }
  const std::vector<std::uint8_t> flat_before = flat, before = noisy;
  simulated::compress(flat, kWidth);
  EXPECT_EQ(flat, flat_before);
  simulated::compress(noisy, kWidth);
  EXPECT_NE(noisy, before);
  double power = 0, power_before = 0;
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    power += std::pow(noisy[i] - 97, 2);
    power_before += std::pow(before[i] - 97, 2);
    EXPECT_LE(std::abs(noisy[i] - before[i]), 8);
  }
  EXPECT_LT(power, power_before) << "fine noise of two grey values is mostly rounded away";
  auto again = noisy;
  simulated::compress(again, kWidth);
  for (std::size_t i = 0; i < noisy.size(); ++i) EXPECT_LE(std::abs(again[i] - noisy[i]), 2);
}

}  // namespace
}  // namespace fathom
