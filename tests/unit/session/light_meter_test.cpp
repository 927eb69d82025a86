// SPDX-License-Identifier: Apache-2.0
#include "session/light_meter.hpp"

#include <gtest/gtest.h>

namespace fathom {
namespace {

constexpr Window kWindow{8, 8, 16};

/// 32 x 32 px: a checkerboard of `contrast` round `grey` in the window, and white round it.
Frame picture(double grey, double contrast) {
  std::vector<std::uint8_t> pixels(32 * 32, 255);
  for (int y = kWindow.y; y < kWindow.y + kWindow.n; ++y) {
    for (int x = kWindow.x; x < kWindow.x + kWindow.n; ++x) {
      const double value = grey + ((x + y) % 2 == 0 ? contrast : -contrast);
      pixels[static_cast<std::size_t>(y * 32 + x)] =
          static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
    }
  }
  return Frame(32, 32, std::move(pixels));
}

std::optional<PoorLight> judged(const std::vector<Frame>& pictures) {
  LightMeter light(kWindow);
  for (const Frame& frame : pictures) light.see(frame);
  return light.judge(20);
}

std::vector<Frame> alike(double grey, double contrast) {
  std::vector<Frame> pictures;
  for (int i = 0; i < 5; ++i) pictures.push_back(picture(grey, contrast));
  return pictures;
}

TEST(Light, OfAnOrdinaryPictureIsGood) {
  EXPECT_FALSE(judged({}));
  for (const double grey : {30.0, 120.0, 200.0}) EXPECT_FALSE(judged(alike(grey, 20)));
  EXPECT_FALSE(judged(alike(100, 100)));
}

TEST(Light, ThatIsWantingIsDark) {
  const auto light = judged(alike(6, 3));
  ASSERT_TRUE(light);
  EXPECT_EQ(light->kind, PoorLight::Kind::dark);
  EXPECT_NEAR(light->part, 6.0 / 255, 0.002);
  EXPECT_EQ(light->exposure_ms, 20);
}

TEST(Light, OfAStarOnADarkSkyIsGood) {
  std::vector<Frame> pictures;
  std::vector<std::uint8_t> pixels(32 * 32, 3);
  pixels[16 * 32 + 16] = 200;
  pictures.emplace_back(32, 32, std::move(pixels));
  EXPECT_FALSE(judged(pictures));
}

TEST(Light, ThatIsTooMuchIsBright) {
  const auto light = judged(alike(250, 30));
  ASSERT_TRUE(light);
  EXPECT_EQ(light->kind, PoorLight::Kind::bright);
  EXPECT_NEAR(light->part, 0.5, 0.01);
}

TEST(Light, ThatComesAndGoesFlickers) {
  std::vector<Frame> pictures;
  for (const double grey : {100.0, 104.0, 101.0, 99.0}) pictures.push_back(picture(grey, 20));
  const auto light = judged(pictures);
  ASSERT_TRUE(light);
  EXPECT_EQ(light->kind, PoorLight::Kind::flickering);
  EXPECT_NEAR(light->part, 0.05, 0.005);
}

}  // namespace
}  // namespace fathom
