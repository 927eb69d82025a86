// SPDX-License-Identifier: Apache-2.0
// A map believes nothing that its pictures do not tell: noise of many shapes, and a focus beyond the
// frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "backends/backends.hpp"
#include "bench/depth/scenes.hpp"
#include "depth/align.hpp"
#include "depth/chance.hpp"
#include "depth/ends.hpp"
#include "depth/mapper.hpp"

namespace fathom {
namespace {

using scenes::Shape;
using scenes::Texture;

constexpr int kWidth = 192, kHeight = 128;
constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;

using Grey = std::vector<double>;

Frame frame_of(const Grey& grey) {
  std::vector<std::uint8_t> pixels;
  for (const double value : grey)
    pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0, 255.0)));
  return Frame(kWidth, kHeight, std::move(pixels));
}

Grey white_noise(double deviation, std::mt19937& random) {
  std::normal_distribution<double> normal(128, deviation);
  Grey grey(kPixels);
  for (double& value : grey) value = normal(random);
  return grey;
}

/// What JPEG leaves of noise: blocks of 8 x 8 px, of which here and there one has detail.
Grey noise_in_blocks(std::mt19937& random) {
  Grey grey = white_noise(6, random);
  std::uniform_real_distribution<double> chance(0, 1);
  for (int top = 0; top < kHeight; top += 8) {
    for (int left = 0; left < kWidth; left += 8) {
      if (chance(random) < 0.15) continue;
      for (int i = 0; i < 64; ++i)
        grey[static_cast<std::size_t>(top + i / 8) * kWidth + left + i % 8] = 128;
    }
  }
  return grey;
}

/// Noise that a camera has smoothed.
Grey smooth_noise(std::mt19937& random) {
  Grey grey = white_noise(60, random);
  for (int pass = 0; pass < 6; ++pass) {
    const Grey before = grey;
    for (int y = 1; y + 1 < kHeight; ++y) {
      for (int x = 1; x + 1 < kWidth; ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * kWidth + x;
        grey[i] = (4 * before[i] + before[i - 1] + before[i + 1] + before[i - kWidth] +
                   before[i + kWidth]) /
                  8;
      }
    }
  }
  return grey;
}

DepthMaps map_of(const std::vector<Frame>& frames) {
  std::vector<double> positions;
  for (std::size_t i = 0; i < frames.size(); ++i) positions.push_back(static_cast<double>(i));
  DepthMapper mapper(
      [](const MetricSpec& spec, std::size_t windows) {
        return select_device(all_backends(), "cpu", spec, windows);
      },
      kWidth, kHeight, positions);
  for (std::size_t i = 0; i < frames.size(); ++i) mapper.add(i, frames[i]);
  return mapper.finish();
}

template <class Make>
std::vector<Frame> stack_of(int frames, unsigned seed, const Make& make) {
  std::mt19937 random(seed);
  std::vector<Frame> stack;
  for (int i = 0; i < frames; ++i) stack.push_back(frame_of(make(random)));
  return stack;
}

/// The part of the columns from `left` to `right` that has a depth.
double known_in(const DepthMaps& maps, int left = 0, int right = kWidth) {
  std::size_t known = 0;
  for (std::size_t i = 0; i < kPixels; ++i) {
    const auto x = static_cast<int>(i % kWidth);
    known += x >= left && x < right && maps.classes[i] == DepthClass::known;
  }
  return static_cast<double>(known) / (kHeight * (right - left));
}

TEST(HonestMap, KnowsNothingOfNoise) {
  const auto white = [](std::mt19937& random) { return white_noise(8, random); };
  for (const int frames : {12, 25}) {
    SCOPED_TRACE(testing::Message() << frames << " frames");
    EXPECT_LE(known_in(map_of(stack_of(frames, 2, white))), 0.001);
    EXPECT_LE(known_in(map_of(stack_of(frames, 3, noise_in_blocks))), 0.01);
    EXPECT_LE(known_in(map_of(stack_of(frames, 4, smooth_noise))), 0.01);
  }
}

TEST(HonestMap, KnowsTextureBesideNoiseInBlocks) {
  const scenes::Scene scene = scenes::make(
      Texture::pink, Shape::slope, {.width_px = kWidth, .height_px = kHeight, .frames = 20});
  std::mt19937 random(5);
  std::vector<Frame> frames;
  for (const Frame& frame : scene.frames) {
    Grey grey = noise_in_blocks(random);
    for (std::size_t i = 0; i < kPixels; ++i) {
      const auto x = static_cast<int>(i % kWidth), y = static_cast<int>(i / kWidth);
      if (x < kWidth / 2) grey[i] = frame.at(x, y);
    }
    frames.push_back(frame_of(grey));
  }
  const DepthMaps maps = map_of(frames);
  constexpr int kRim = 24;
  EXPECT_GT(known_in(maps, 0, kWidth / 2 - kRim), 0.9);
  EXPECT_LT(known_in(maps, kWidth / 2 + kRim, kWidth), 0.02);
}

TEST(HonestMap, KnowsNothingOfAFocusBeyondTheFrames) {
  for (const Texture texture : {Texture::pink, Texture::white, Texture::sparse}) {
    SCOPED_TRACE(to_string(texture));
    const scenes::Options options{
        .width_px = kWidth, .height_px = kHeight, .frames = 40, .px_per_frame = 1.2};
    // The nearest focus is at 4.7 frames, the farthest at 34.
    std::vector<Frame> frames = scenes::make(texture, Shape::cone, options).frames;
    frames.resize(5);
    const DepthMaps maps = map_of(frames);
    EXPECT_LE(known_in(maps), 0.01);
    EXPECT_GT(std::ranges::count(maps.classes, DepthClass::at_end), 0.3 * kPixels);
  }
}

TEST(HonestMap, DoesNotAlignNoise) {
  for (const unsigned seed : {1u, 2u}) {
    std::mt19937 random(seed);
    StackAligner aligner(Alignment::similarity);
    for (int i = 0; i < 12; ++i)
      EXPECT_EQ(aligner.add(frame_of(smooth_noise(random))), Similarity{}) << seed << ", " << i;
  }
}

namespace d = depth;

TEST(Ends, HoldWhatStandsAboveBoth) {
  const std::vector<double> positions = {0, 1, 2, 3, 4, 5, 6};
  const d::Ends ends(positions, 1);
  const std::vector<float> peak = {0, 1, 3, 9, 3, 1, 0}, rising = {0, 1, 2, 3, 5, 7, 9};
  const std::vector<float> hump = {0, 1, 4, 2, 4, 7, 9}, level(7, 2);
  EXPECT_TRUE(ends.lie_below(peak, 3.1));
  EXPECT_TRUE(ends.hold(peak));
  EXPECT_FALSE(ends.lie_below(rising, 4.5));
  EXPECT_FALSE(ends.hold(rising));
  EXPECT_FALSE(ends.lie_below(hump, 2));  // A hump on the way to the end.
  EXPECT_FALSE(ends.lie_below(level, 3));
  // One frame from the end is enough, where that is lower.
  EXPECT_TRUE(ends.lie_below(std::vector<float>{4, 9, 4, 1, 0, 0, 0}, 1));
}

TEST(Chance, IsWhatDisorderTellsAsOftenAsOrder) {
  d::Chance chance(3);
  // Noise that tells 20 to 40: one place in four tells most in order.
  for (int i = 0; i < 400; ++i) {
    const float less = 20, more = 20 + static_cast<float>(i % 20);
    i % 4 == 0 ? chance.add(more + 1, 1, less, 1) : chance.add(less, 1, more + 1, 1);
  }
  // Texture tells 100 to 300.
  for (int i = 0; i < 200; ++i) chance.add(100 + static_cast<float>(i), 1, 40, 1);
  chance.settle();
  EXPECT_GT(chance.of(25), 0.75f);
  EXPECT_GT(chance.of(35), 0.75f);
  EXPECT_LT(chance.of(150), 0.05f);
  EXPECT_LT(chance.of(250), 0.05f);
}

}  // namespace
}  // namespace fathom
