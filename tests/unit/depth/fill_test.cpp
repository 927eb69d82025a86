// SPDX-License-Identifier: Apache-2.0
// What is not known is closed from around it.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "depth/mapper.hpp"

namespace fathom {
namespace {

constexpr int kWidth = 64, kHeight = 48;

template <class PositionAt>
DepthMaps maps_of(const PositionAt& position_at) {
  DepthMaps maps{.width_px = kWidth,
                 .height_px = kHeight,
                 .position = {},
                 .sigma = std::vector<float>(kWidth * kHeight, 0.1f),
                 .confidence = std::vector<float>(kWidth * kHeight, 1),
                 .classes = std::vector<DepthClass>(kWidth * kHeight, DepthClass::known)};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) maps.position.push_back(position_at(x, y));
  }
  return maps;
}

void forget(DepthMaps& maps, int x, int y, DepthClass kind) {
  const int pixel = y * kWidth + x;
  maps.classes[pixel] = kind;
  maps.position[pixel] = maps.sigma[pixel] = maps.confidence[pixel] =
      std::numeric_limits<float>::quiet_NaN();
}

TEST(Fill, ClosesAHoleSmoothlyAndIsLessSureInItsMiddle) {
  DepthMaps maps = maps_of([](int x, int) { return 100 + 0.5f * static_cast<float>(x); });
  for (int y = 16; y < 32; ++y) {
    for (int x = 24; x < 40; ++x) forget(maps, x, y, DepthClass::no_texture);
  }
  fill(maps);
  for (int y = 16; y < 32; ++y) {
    for (int x = 24; x < 40; ++x) {
      const int pixel = y * kWidth + x;
      EXPECT_EQ(maps.classes[pixel], DepthClass::filled);
      EXPECT_EQ(maps.confidence[pixel], 0);
      EXPECT_NEAR(maps.position[pixel], 100 + 0.5 * x, 3);
      EXPECT_NEAR(maps.position[pixel], maps.position[pixel - 1], 1.5);
      EXPECT_GT(maps.sigma[pixel], 0.1f);
    }
  }
  EXPECT_GT(maps.sigma[24 * kWidth + 32], 1.3f * maps.sigma[24 * kWidth + 24]);
  EXPECT_EQ(maps.classes[0], DepthClass::known);
  EXPECT_EQ(maps.position[24 * kWidth + 10], 105);
}

TEST(Fill, KeepsACliffAtTheNearerSide) {
  DepthMaps maps = maps_of([](int x, int) { return x < 32 ? 5.0f : 20.0f; });
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 28; x < 36; ++x) forget(maps, x, y, DepthClass::two_depths);
  }
  fill(maps);
  for (int x = 28; x < 36; ++x) EXPECT_EQ(maps.position[24 * kWidth + x], x < 32 ? 5 : 20) << x;
}

TEST(Fill, PutsACliffWhereTheGuideHasAnEdge) {
  DepthMaps maps = maps_of([](int x, int) { return x < 32 ? 5.0f : 20.0f; });
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 28; x < 36; ++x) forget(maps, x, y, DepthClass::two_depths);
    for (int x = 0; x < kWidth; ++x) pixels.push_back(x < 34 ? 60 : 200);
  }
  const Frame guide(kWidth, kHeight, std::move(pixels));
  fill(maps, &guide);
  for (int x = 28; x < 36; ++x) EXPECT_EQ(maps.position[24 * kWidth + x], x < 34 ? 5 : 20) << x;
}

TEST(Fill, IsNoSurerThanTheMapIsLevel) {
  // A slope whose right half is not known: the fill cannot know that it goes on.
  const auto slope = [](int x, int) { return 100 + 0.5f * static_cast<float>(x); };
  for (const DepthClass kind : {DepthClass::no_texture, DepthClass::at_end}) {
    DepthMaps maps = maps_of(slope);
    maps.lowest = 90;
    maps.highest = 200;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = kWidth / 2; x < kWidth; ++x) forget(maps, x, y, kind);
    }
    fill(maps);
    for (int x = kWidth / 2; x < kWidth; ++x) {
      const int pixel = 24 * kWidth + x;
      const float off = std::abs(maps.position[pixel] - slope(x, 24));
      EXPECT_LT(off, 2 * maps.sigma[pixel]) << x;
      // What is sharpest at an end may lie at either, or beyond.
      const float least = kind == DepthClass::at_end ? 200 - maps.position[pixel] : 0;
      EXPECT_GE(maps.sigma[pixel], least) << x;
    }
  }
}

TEST(Fill, LeavesAMapOfNothing) {
  DepthMaps maps = maps_of([](int, int) { return 1.0f; });
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) forget(maps, x, y, DepthClass::at_end);
  }
  fill(maps);
  EXPECT_EQ(maps.classes, std::vector<DepthClass>(kWidth * kHeight, DepthClass::at_end));
  EXPECT_TRUE(std::isnan(maps.position[100]));
}

}  // namespace
}  // namespace fathom
