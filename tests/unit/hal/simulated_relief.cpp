// SPDX-License-Identifier: Apache-2.0
// Targets whose depth is known at every pixel: that they are blurred by it, and tell it.
#include <cmath>
#include <numbers>

#include "hal/drivers/simulated/discs.hpp"
#include "hal/drivers/simulated/relief.hpp"
#include "hal/drivers/simulated/thin_lens.hpp"
#include "simulated_support.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

using namespace simulated;

constexpr std::size_t at(int x, int y) { return static_cast<std::size_t>(y) * kWidthPx + x; }

/// Root mean square of what differs in some columns.
double difference(const std::vector<float>& one, const std::vector<float>& other, int from,
                  int to) {
  double sum = 0;
  for (int y = 0; y < kHeightPx; ++y) {
    for (int x = from; x < to; ++x) sum += std::pow(one[at(x, y)] - other[at(x, y)], 2);
  }
  return std::sqrt(sum / (double{kHeightPx} * (to - from)));
}

Relief stair_of_two() { return {Target::stair, {.step_mm = 100, .steps = 2}, 1500, 7}; }

int steps_for(double distance_mm) {
  return static_cast<int>(std::lround(focused_position_steps(distance_mm)));
}

TEST(DiscsTest, SpreadAPointEvenlyOverItsDisc) {
  for (const double radius : {0.2, 0.7, 1.5, 5.0, 20.3}) {
    Discs discs;
    discs.add(100, 90, radius, 0.5, 1);
    const std::vector<Spread> sums = discs.sum();
    double light = 0, weight = 0, across = 0, down = 0;
    for (int y = 0; y < kHeightPx; ++y) {
      for (int x = 0; x < kWidthPx; ++x) {
        light += sums[at(x, y)].light;
        weight += sums[at(x, y)].weight;
        across += sums[at(x, y)].weight * std::pow(x - 100, 2);
        down += sums[at(x, y)].weight * std::pow(y - 90, 2);
      }
    }
    EXPECT_NEAR(weight, 1, 1e-3);
    EXPECT_NEAR(light, 0.5, 1e-3);
    if (radius < 5) continue;
    // A disc's second moment about its middle is r^2/4, and the pixels' own some 1/12 or less.
    EXPECT_NEAR(across, radius * radius / 4, 0.01 * radius * radius + 0.1) << radius;
    EXPECT_NEAR(down, radius * radius / 4, 0.01 * radius * radius + 0.1) << radius;
    EXPECT_NEAR(sums[at(100, 90)].weight * std::numbers::pi * radius * radius, 1, 0.02) << radius;
  }
}

TEST(DiscsTest, DropWhatFallsOutside) {
  Discs discs;
  discs.add(0, 100, 10, 1, 1);
  discs.add(-30, 20, 10, 1, 1);
  discs.add(50, kHeightPx + 30, 10, 1, 1);
  double weight = 0;
  for (const Spread& sum : discs.sum()) weight += sum.weight;
  EXPECT_NEAR(weight, 0.5 + 0.5 / (std::numbers::pi * 5), 0.01);  // half, and half of the middle
}

TEST(ReliefTest, TellsTheDistanceOfEveryPixel) {
  const Relief slant(Target::slant, {.slope_mm = 0.5}, 1500, 7);
  EXPECT_DOUBLE_EQ(slant.distance_mm(kMiddleXPx, 3), 1500);
  EXPECT_DOUBLE_EQ(slant.distance_mm(kMiddleXPx + 100, 200), 1550);
  EXPECT_DOUBLE_EQ(stair_of_two().distance_mm(127, 5), 1550);
  EXPECT_DOUBLE_EQ(stair_of_two().distance_mm(128, 5), 1450);
  const Relief sphere(Target::sphere, {.radius_mm = 20}, 1500, 7);
  EXPECT_DOUBLE_EQ(sphere.distance_mm(kMiddleXPx, kMiddleYPx), 1500);
  EXPECT_DOUBLE_EQ(sphere.distance_mm(0, 0), 1540);
  const double aside_mm = 30 * kPitchMm / magnification(1500);
  EXPECT_NEAR(sphere.distance_mm(kMiddleXPx, kMiddleYPx + 30),
              1520 - std::sqrt(400 - aside_mm * aside_mm), 1e-9);
}

TEST(ReliefTest, IsSharpestWhereTheLensIsFocused) {
  SimulatedRig rig("sim:target=slant,distance=1500,noise=0,slope=0.8");
  const auto score_at = [&](double distance_mm, int x) {
    rig.lens().move_to(steps_for(distance_mm));
    const Frame frame = rig.grab();
    const auto device = select_device(all_backends(), "reference", MetricSpec::parse("fft:32"), 1);
    return device.device->plan(MetricSpec::parse("fft:32"), 1)->score(frame, {x - 16, 100, 32});
  };
  for (const int x : {40, 128, 215}) {
    const double there = rig.stage().distance_mm(x - 0.5, 116);
    EXPECT_GT(score_at(there, x), score_at(there + 35, x)) << x;
    EXPECT_GT(score_at(there, x), score_at(there - 35, x)) << x;
  }
  EXPECT_EQ(rig.stage().distance_mm(kMiddleXPx, 0), 1500);
  rig.stage().place_at(2000);
  EXPECT_EQ(rig.stage().distance_mm(kMiddleXPx, 0), 2000);
}

TEST(ReliefTest, LetsNearSurfacesCoverFarOnes) {
  const int edge = kWidthPx / 2;
  const int near = steps_for(1450), far = steps_for(1550);
  // The sharp near surface is not touched by what is blurred behind it, up to its edge.
  const std::vector<float> on_near = stair_of_two().picture(near, 4);
  const std::vector<float> deep_on_near = stair_of_two().picture(near, 32);
  EXPECT_LT(difference(on_near, deep_on_near, edge + 2, edge + 6), 0.01);
  EXPECT_GT(difference(on_near, deep_on_near, edge - 6, edge - 2), 0.03);
  // The blurred near surface lies over the sharp far one beside its edge, and no farther.
  const std::vector<float> on_far = stair_of_two().picture(far, 4);
  const std::vector<float> deep_on_far = stair_of_two().picture(far, 32);
  const double beside = difference(on_far, deep_on_far, edge - 2, edge);
  const double away = difference(on_far, deep_on_far, edge - 40, edge - 20);
  EXPECT_GT(beside, 0.02);
  EXPECT_LT(away, 0.01);
}

TEST(ReliefTest, GrowsAsAThinLensHasIt) {
  const int focused = 900, moved = 1100;
  const double distance_mm = focused_distance_mm(focused);
  const Relief still(Target::slant, {.slope_mm = 0}, distance_mm, 7);
  const Relief breathing(Target::slant, {.slope_mm = 0, .breathes = true}, distance_mm, 7);
  EXPECT_LT(difference(still.picture(focused, 32), breathing.picture(focused, 32), 0, kWidthPx),
            1e-5);
  const double growth =
      (kFocalLengthMm + extension_mm(moved)) / (kFocalLengthMm + extension_mm(focused));
  ASSERT_GT(growth, 1.015);
  const std::vector<float> seen = breathing.picture(moved, 8), before = still.picture(moved, 8);
  std::vector<float> grown(seen.size());
  for (int y = 0; y < kHeightPx; ++y) {
    for (int x = 0; x < kWidthPx; ++x) {
      const double u = kMiddleXPx + (x - kMiddleXPx) / growth;
      const double v = kMiddleYPx + (y - kMiddleYPx) / growth;
      const int i = std::min(static_cast<int>(u), kWidthPx - 2);
      const int j = std::min(static_cast<int>(v), kHeightPx - 2);
      const double upper = std::lerp(before[at(i, j)], before[at(i + 1, j)], u - i);
      const double lower = std::lerp(before[at(i, j + 1)], before[at(i + 1, j + 1)], u - i);
      grown[at(x, y)] = static_cast<float>(std::lerp(upper, lower, v - j));
    }
  }
  EXPECT_LT(difference(seen, grown, 0, kWidthPx), 0.25 * difference(seen, before, 0, kWidthPx));
}

TEST(ReliefTest, TakesTheKeysOfItsTargetAlone) {
  for (const char* const text :
       {"sim:slope=1", "sim:target=stair,slope=1", "sim:target=slant,steps=3", "sim:breathing=on",
        "sim:target=slant,slope=9", "sim:target=stair,steps=1", "sim:target=sphere,radius=0"}) {
    expect_error(ErrorCode::bad_argument, [&] { SimulatedRig rig(text); });
  }
  SimulatedRig steep("sim:target=stair,step=50,steps=3");
  EXPECT_EQ(steep.stage().distance_mm(0, 0), steep.stage().distance_mm() + 50);
}

}  // namespace
}  // namespace fathom::test
