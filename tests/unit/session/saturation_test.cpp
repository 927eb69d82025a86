// SPDX-License-Identifier: Apache-2.0
#include "session/saturation.hpp"

#include <gtest/gtest.h>

namespace fathom {
namespace {

template <class Grey>
Frame frame_of(Grey low, Grey high, int count) {
  std::vector<Grey> pixels(16 * 16, low);
  for (int i = 0; i < count; ++i) pixels[i + 16 * 4 + 4] = high;  // within columns 4.. of row 4
  return Frame(16, 16, std::move(pixels));
}

constexpr Window kWindow{4, 4, 8};

TEST(SaturatedPart, CountsTheWindowsPixelsAtTheMaximum) {
  EXPECT_EQ(saturated_part(frame_of<std::uint8_t>(9, 255, 6), kWindow), 6.0 / 64);
  EXPECT_EQ(saturated_part(frame_of<std::uint8_t>(9, 254, 6), kWindow), 0);
  EXPECT_EQ(saturated_part(frame_of<std::uint8_t>(255, 255, 0), kWindow), 1);
  EXPECT_EQ(saturated_part(frame_of<std::uint8_t>(9, 255, 6), {4, 8, 8}), 0) << "outside of it";
}

TEST(SaturatedPart, KnowsCamerasOfTenToSixteenBits) {
  for (const int bits : {10, 12, 14, 16}) {
    const auto highest = static_cast<std::uint16_t>((1 << bits) - 1);
    EXPECT_EQ(saturated_part(frame_of<std::uint16_t>(9, highest, 4), kWindow), 4.0 / 64) << bits;
    const auto below = static_cast<std::uint16_t>(highest - 1);
    EXPECT_EQ(saturated_part(frame_of<std::uint16_t>(9, below, 4), kWindow), 0) << bits;
    const int shift = 16 - bits;  // the same in the high bits
    const auto left = static_cast<std::uint16_t>(highest << shift);
    EXPECT_EQ(saturated_part(frame_of<std::uint16_t>(9, left, 4), kWindow), 4.0 / 64) << bits;
    const auto dimmer = static_cast<std::uint16_t>(below << shift);
    EXPECT_EQ(saturated_part(frame_of<std::uint16_t>(9, dimmer, 4), kWindow), 0) << bits;
  }
}

Measurement at(double position, double saturated) {
  Measurement m;
  m.position = position;
  m.picture.saturated = saturated;
  return m;
}

TEST(SaturationAt, IsOfTheMeasurementNearestToThePeak) {
  const std::vector<Measurement> run = {at(0, 0.9), at(10, 0.26), at(20, 0.001)};
  const auto saturation = saturation_at(run, 11.5);
  ASSERT_TRUE(saturation);
  EXPECT_EQ(saturation->part, 0.26);
  EXPECT_EQ(saturation->position, 10);
  EXPECT_FALSE(saturation_at(run, 19));
  EXPECT_FALSE(saturation_at({}, 19));
}

}  // namespace
}  // namespace fathom
