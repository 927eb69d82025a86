// SPDX-License-Identifier: Apache-2.0
// Gains of pictures whose light is known, and what a map and a sharp picture make of them.
#include "depth/stack_light.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "backends/backends.hpp"
#include "bench/depth/scenes.hpp"
#include "depth/mapper.hpp"
#include "depth/sharp.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

constexpr int kWidth = 192, kHeight = 160;

using Light = std::function<double(std::size_t frame, int x, int y)>;

/// A frame in another light, in 8 or 16 bits; what is above 255 is clipped.
template <class Sample = std::uint8_t>
Frame lit(const Frame& frame, double unit, const std::function<double(int, int)>& light) {
  std::vector<Sample> samples;
  for (int y = 0; y < frame.height_px(); ++y) {
    for (int x = 0; x < frame.width_px(); ++x) {
      const double value = std::clamp(light(x, y) * frame.at(x, y), 0.0, 255.0);
      samples.push_back(static_cast<Sample>(std::lround(unit * value)));
    }
  }
  return Frame(frame.width_px(), frame.height_px(), std::move(samples));
}

scenes::Scene scene() {
  return scenes::make(scenes::Texture::pink, scenes::Shape::slope,
                      {.width_px = kWidth,
                       .height_px = kHeight,
                       .frames = 15,
                       .px_per_frame = 2.4,
                       .noise = 1,
                       .seed = 7});
}

double flicker(std::size_t frame) { return 1 + 0.2 * std::sin(2.0 * static_cast<double>(frame)); }

/// The farthest that a gain is from the light, as a part of it.
double worst_gain(const scenes::Scene& scene, const Light& light) {
  StackLight levels;
  double most = 0;
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    const double gain =
        levels.add(lit(scene.frames[i], 1, [&](int x, int y) { return light(i, x, y); }));
    most = std::max(most, std::abs(gain * flicker(i) / flicker(0) - 1));
  }
  return most;
}

TEST(StackLight, TellsAFlickerWhateverIsInFocus) {
  const scenes::Scene stack = scene();
  EXPECT_LT(worst_gain(stack, [](std::size_t i, int, int) { return flicker(i); }), 0.003);
}

TEST(StackLight, LeavesOutWhatIsClipped) {
  const scenes::Scene stack = scene();
  // A quarter of the brightest picture is clipped: plain means would be off by 0.1.
  EXPECT_LT(worst_gain(stack, [](std::size_t i, int, int) { return 1.7 * flicker(i); }), 0.04);
}

TEST(StackLight, DoesNotMindWhatChangesInAPartOfThePicture) {
  const scenes::Scene stack = scene();
  const Light light = [](std::size_t i, int x, int y) {
    const bool is_lamp = i % 2 == 1 && x > 150 && y > 100;
    return (is_lamp ? 2 : 1) * flicker(i);
  };
  EXPECT_LT(worst_gain(stack, light), 0.02);
}

TEST(StackLight, ComparesTheSamePlaces) {
  // Bright on the left, dark on the right: what moves in on one side is not light that changes.
  std::vector<std::uint8_t> before, after;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      before.push_back(static_cast<std::uint8_t>(200 - 0.8 * x));
      after.push_back(static_cast<std::uint8_t>(200 - 0.8 * (x - 30)));
    }
  }
  StackLight levels;
  levels.add(Frame(kWidth, kHeight, std::move(before)));
  const double gain = levels.add(Frame(kWidth, kHeight, std::move(after)), {.dx_px = 30});
  EXPECT_NEAR(gain, 1, 0.005);
}

TEST(StackLight, TakesEveryPictureAndRefusesOtherSizes) {
  for (const auto& [width, height] : {std::pair{1, 1}, {5, 3}, {64, 2}, {700, 31}}) {
    StackLight levels;
    const std::size_t pixels = std::size_t{1} * width * height;
    EXPECT_EQ(levels.add(Frame(width, height, std::vector<std::uint8_t>(pixels, 0))), 1);
    EXPECT_GT(levels.add(Frame(width, height, std::vector<std::uint8_t>(pixels, 255))), 0);
    EXPECT_GT(levels.add(Frame(width, height, std::vector<std::uint8_t>(pixels, 0))), 0);
    EXPECT_THROW(levels.add(Frame(width + 1, height, std::vector<std::uint8_t>(pixels + height))),
                 Error);
  }
}

/// Maps and sharp picture of a stack in some light, with gains for both.
struct Made {
  DepthMaps maps;
  Sharp sharp;
};
Made made_of(const scenes::Scene& stack, const std::function<double(std::size_t)>& light) {
  std::vector<double> positions;
  for (std::size_t i = 0; i < stack.frames.size(); ++i) positions.push_back(static_cast<double>(i));
  const auto open = [](const MetricSpec& spec, std::size_t windows) {
    return select_device(all_backends(), "cpu", spec, windows);
  };
  DepthMapper mapper(open, kWidth, kHeight, positions);
  SharpPicture sharp(kWidth, kHeight, Depth::bits16, false);
  StackLight levels;
  for (std::size_t i = 0; i < stack.frames.size(); ++i) {
    const Frame frame =
        lit<std::uint16_t>(stack.frames[i], 100, [&](int, int) { return light(i); });
    const double gain = levels.add(frame);
    mapper.add(i, frame, {}, gain);
    sharp.add(i, frame, {}, {}, gain);
  }
  Made made;
  made.sharp = sharp.finish();
  made.maps = mapper.finish();
  return made;
}

TEST(StackLight, MakesTheSameMapAndPictureOfAStackThatFlickers) {
  const scenes::Scene stack = scene();
  const Made steady = made_of(stack, [](std::size_t) { return 1.0; });
  const Made flickering = made_of(stack, [](std::size_t i) { return flicker(i) / flicker(0); });
  double map_off = 0, grey_off = 0, other_frames = 0;
  for (std::size_t i = 0; i < steady.maps.position.size(); ++i) {
    map_off =
        std::max(map_off, std::abs(double{steady.maps.position[i]} - flickering.maps.position[i]));
    const auto [y, x] = std::div(static_cast<int>(i), kWidth);
    grey_off += std::pow((static_cast<double>(steady.sharp.grey.at(x, y)) -
                          static_cast<double>(flickering.sharp.grey.at(x, y))) /
                             100,
                         2);
    other_frames += steady.sharp.frame[i] == flickering.sharp.frame[i] ? 0 : 1;
  }
  const auto pixels = static_cast<double>(steady.maps.position.size());
  EXPECT_LT(map_off, 0.1);                       // frames
  EXPECT_LT(std::sqrt(grey_off / pixels), 0.5);  // levels of 8 bits
  EXPECT_LT(other_frames / pixels, 0.03);
}

}  // namespace
}  // namespace fathom
