// SPDX-License-Identifier: Apache-2.0
// The optics on scenes so simple that the picture is known without them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hal/drivers/simulated/image_former.hpp"
#include "hal/drivers/simulated/thin_lens.hpp"

namespace fathom::simulated {
namespace {

/// One cell is 1 mm on the object, so one pixel is 2 mm. The picture's middle, where the object has
/// its origin, is the corner between pixels 127 and 128 across and 119 and 120 down.
constexpr double kCellMm = 1;

float at(const std::vector<float>& picture, int x, int y) {
  return picture[static_cast<std::size_t>(y) * kWidthPx + x];
}

std::vector<float> picture(const Scene& scene, std::vector<double> discs_mm) {
  return ImageFormer(scene).picture(discs_mm);
}

TEST(SimulatedImageFormer, ASharpEdgeCoversItsPartOfAPixel) {
  Scene scene;
  Layer& card = scene.layers.emplace_back(0, kCellMm);
  card.fill(0);
  card.paint_rectangle(0.5, -200, 3.0, 400, 1);  // from 1/4 of pixel 128 to 3/4 of pixel 129
  const auto seen = picture(scene, {0});
  EXPECT_NEAR(at(seen, 127, 120), 0, 1e-5);
  EXPECT_NEAR(at(seen, 128, 120), 0.75, 1e-5);
  EXPECT_NEAR(at(seen, 129, 120), 0.75, 1e-5);
  EXPECT_NEAR(at(seen, 130, 120), 0, 1e-5);
}

TEST(SimulatedImageFormer, APointBecomesAnEvenDiscOfItsLight) {
  Scene scene;
  Layer& card = scene.layers.emplace_back(0, kCellMm);
  card.fill(0);
  card.paint_rectangle(-2, -2, 4, 4, 1);  // the four pixels around the middle
  const double radius_px = 20;
  const auto seen = picture(scene, {2 * radius_px * kPitchMm});
  const double even = 4 / (std::numbers::pi * radius_px * radius_px);
  double light = 0;
  for (int y = 0; y < kHeightPx; ++y) {
    for (int x = 0; x < kWidthPx; ++x) {
      light += at(seen, x, y);
      const double distance_px = std::hypot(x - 127.5, y - 119.5);
      if (std::abs(distance_px - radius_px) < 3) continue;  // the rim
      EXPECT_NEAR(at(seen, x, y), distance_px < radius_px ? even : 0, 0.02 * even);
    }
  }
  EXPECT_NEAR(light, 4, 0.01) << "blur neither makes nor takes light";
}

TEST(SimulatedImageFormer, StripesOfOnePixelPeriodAreEvenGrey) {
  // Stripes of one cell, two cells a period: each pixel averages exactly one period, whatever the
  // phase.
  Scene scene;
  Layer& card = scene.layers.emplace_back(0, kCellMm);
  card.fill(0);
  for (int x = -256; x < 256; x += 2) card.paint_rectangle(x, -256, 1, 512, 1);
  for (const float value : picture(scene, {0})) EXPECT_NEAR(value, 0.5, 1e-5);
}

TEST(SimulatedImageFormer, StripesBeyondTheSensorComeBackCoarser) {
  // Period 1.25 px, 0.8 cycles a pixel: the sensor cannot tell it from 0.2, five pixels a period.
  Scene scene;
  Layer& card = scene.layers.emplace_back(0, kCellMm);
  card.fill(0);
  for (int i = -102; i < 102; ++i) card.paint_rectangle(2.5 * i, -256, 1.25, 512, 1);
  const auto seen = picture(scene, {0});
  EXPECT_GT(std::abs(at(seen, 100, 120) - at(seen, 102, 120)), 0.1);
  for (int x = 60; x < 200; ++x) EXPECT_NEAR(at(seen, x, 120), at(seen, x + 5, 120), 1e-3) << x;
}

TEST(SimulatedImageFormer, NearerLayersHideFartherOnesEachWithItsOwnBlur) {
  Scene scene;
  Layer& back = scene.layers.emplace_back(0, kCellMm);
  back.fill(0.2);
  Layer& front = scene.layers.emplace_back(10, kCellMm);
  front.paint_rectangle(0, -256, 40, 512, 0.8);  // pixels 128 to 147
  const auto sharp = picture(scene, {0, 0});
  EXPECT_NEAR(at(sharp, 127, 120), 0.2, 1e-4);
  EXPECT_NEAR(at(sharp, 128, 120), 0.8, 1e-4);
  const auto soft = picture(scene, {0, 10 * kPitchMm});
  // A straight edge through the centre of a disc halves it.
  EXPECT_NEAR((at(soft, 127, 120) + at(soft, 128, 120)) / 2, 0.5, 1e-3);
  EXPECT_NEAR(at(soft, 120, 120), 0.2, 1e-2);
  EXPECT_NEAR(at(soft, 138, 120), 0.8, 1e-2);
  EXPECT_EQ(picture(scene, {10 * kPitchMm, 0}), sharp) << "the card behind is even, blurred or not";
}

TEST(SimulatedImageFormer, NothingShowsTheGreyCard) {
  for (const float value : picture(Scene{}, {})) EXPECT_EQ(value, static_cast<float>(kGreyCard));
}

TEST(SimulatedScene, BarsOfTheChartHaveTheirStandardWidth) {
  // Group -2, element 1: 0.25 line pairs a mm, bars of 2 mm, its left edge 2.7 lines left of the
  // middle.
  const Scene chart = draw_scene(Target::usaf, 1500, 1);
  const Layer& layer = chart.layers.front();
  const int row = kFieldCells / 2 + static_cast<int>(10 / layer.cell_mm());
  std::vector<double> edges_mm;
  for (int col = kFieldCells / 2 - 40; col < kFieldCells / 2 + 20; ++col) {
    const auto left = layer.cells()[static_cast<std::size_t>(row) * kFieldCells + col].real();
    const auto right = layer.cells()[static_cast<std::size_t>(row) * kFieldCells + col + 1].real();
    const bool crosses = (left > 0.45) != (right > 0.45);
    if (crosses) edges_mm.push_back((col - kFieldCells / 2 + 1) * layer.cell_mm());
  }
  ASSERT_GE(edges_mm.size(), 4u);
  EXPECT_NEAR(edges_mm[0], -5.4, layer.cell_mm());
  for (std::size_t i = 1; i < 4; ++i)
    EXPECT_NEAR(edges_mm[i] - edges_mm[0], 2.0 * static_cast<double>(i), layer.cell_mm());
}

}  // namespace
}  // namespace fathom::simulated
