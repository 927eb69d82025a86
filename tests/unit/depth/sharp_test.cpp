// SPDX-License-Identifier: Apache-2.0
// The all-in-focus picture of stacks whose sharp picture is known.
#include "depth/sharp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "depth/placed.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

constexpr int kWidth = 250, kHeight = 190;  // no multiple of a cell
constexpr std::size_t kPixels = std::size_t{1} * kWidth * kHeight;
using Values = std::vector<double>;

double at(const Values& v, int x, int y) {
  return v[static_cast<std::size_t>(std::clamp(y, 0, kHeight - 1)) * kWidth +
           static_cast<std::size_t>(std::clamp(x, 0, kWidth - 1))];
}

Values blurred(const Values& from, int radius) {
  Values to(kPixels);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      double sum = 0;
      for (int j = -radius; j <= radius; ++j) {
        for (int i = -radius; i <= radius; ++i) sum += at(from, x + i, y + j);
      }
      to[static_cast<std::size_t>(y) * kWidth + x] = sum / std::pow(2 * radius + 1, 2);
    }
  }
  return to;
}

/// White texture of the sensor's resolution, on the left brighter than on the right.
Values texture(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  Values grain(kPixels);
  for (double& value : grain) value = normal(random);
  grain = blurred(grain, 1);
  for (std::size_t i = 0; i < kPixels; ++i)
    grain[i] = 120 + 60 * grain[i] + 20 * std::cos(3.0 * static_cast<double>(i % kWidth) / kWidth);
  return grain;
}

/// `left` where the picture's left half is, `right` elsewhere.
Values joined(const Values& left, const Values& right) {
  Values result(kPixels);
  for (std::size_t i = 0; i < kPixels; ++i) result[i] = (i % kWidth < kWidth / 2 ? left : right)[i];
  return result;
}

template <class Sample>
std::vector<Sample> exposed(const Values& values, double unit, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  std::vector<Sample> samples;
  for (const double value : values) {
    const double level = std::clamp(value + (noise > 0 ? normal(random) : 0.0), 0.0, 255.0);
    samples.push_back(static_cast<Sample>(std::lround(unit * level)));
  }
  return samples;
}

/// Root mean square of what differs, in units, away from the edges and from the middle by `margin`.
template <class Sample>
double rms(const std::vector<Sample>& samples, const Values& truth, double unit, int margin) {
  double sum = 0, count = 0;
  for (int y = margin; y < kHeight - margin; ++y) {
    for (int x = margin; x < kWidth - margin; ++x) {
      if (std::abs(x - kWidth / 2) < margin) continue;
      const auto i = static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
      sum += std::pow(static_cast<double>(samples[i]) / unit - truth[i], 2);
      count += 1;
    }
  }
  return std::sqrt(sum / count);
}

std::vector<std::uint16_t> greys_of(const Frame& frame) {
  std::vector<std::uint16_t> greys;
  for (int y = 0; y < frame.height_px(); ++y) {
    for (int x = 0; x < frame.width_px(); ++x)
      greys.push_back(static_cast<std::uint16_t>(frame.at(x, y)));
  }
  return greys;
}

template <class Sample>
void expect_both_halves_sharp(Depth depth, double unit) {
  const Values truth = texture(1), soft = blurred(truth, 3);
  SharpPicture picture(kWidth, kHeight, depth, false);
  const auto left = exposed<Sample>(joined(truth, soft), unit, 1, 2);
  const auto right = exposed<Sample>(joined(soft, truth), unit, 1, 3);
  picture.add(7, Frame(kWidth, kHeight, left), {});
  picture.add(9, Frame(kWidth, kHeight, right), {});
  const Sharp sharp = picture.finish();
  EXPECT_GT(rms(left, truth, unit, 12), 10);
  EXPECT_LT(rms(greys_of(sharp.grey), truth, unit, 12), 1.5);
  EXPECT_LT(rms(greys_of(sharp.grey), truth, unit, 1), 5);  // no seam in the middle
  EXPECT_EQ(sharp.grey.depth(), depth);
  EXPECT_TRUE(sharp.colours.empty());
  EXPECT_EQ(sharp.frame[std::size_t{95} * kWidth + 20], 7);
  EXPECT_EQ(sharp.frame[std::size_t{95} * kWidth + 230], 9);
}

TEST(Sharp, TakesEachHalfFromWhereItIsSharp) {
  expect_both_halves_sharp<std::uint8_t>(Depth::bits8, 1);
  expect_both_halves_sharp<std::uint16_t>(Depth::bits16, 256);
}

TEST(Sharp, GivesAFrameBackThatIsAlone) {
  for (const bool is_wide : {false, true}) {
    const double unit = is_wide ? 256 : 1;
    const Values truth = texture(4);
    const Frame frame = is_wide ? Frame(kWidth, kHeight, exposed<std::uint16_t>(truth, unit, 0, 1))
                                : Frame(kWidth, kHeight, exposed<std::uint8_t>(truth, unit, 0, 1));
    SharpPicture picture(kWidth, kHeight, frame.depth(), false);
    picture.add(0, frame, {});
    EXPECT_EQ(greys_of(picture.finish().grey), greys_of(frame));
  }
}

TEST(Sharp, AveragesNoiseWhereNothingIsSharp) {
  const Values flat(kPixels, 100.0);
  SharpPicture picture(kWidth, kHeight, Depth::bits8, false);
  constexpr int kFrames = 12;
  for (unsigned i = 0; i < kFrames; ++i)
    picture.add(i, Frame(kWidth, kHeight, exposed<std::uint8_t>(flat, 1, 6, i + 1)), {});
  // Picking the frame of most detail would give more than 6; the mean of all gives 1.7.
  EXPECT_LT(rms(greys_of(picture.finish().grey), flat, 1, 4), 3);
}

TEST(Sharp, KeepsColoursAndTheirLuma) {
  const Values truth = texture(5), soft = blurred(truth, 3);
  SharpPicture picture(kWidth, kHeight, Depth::bits8, true);
  const double parts[3] = {1.0, 0.5, 0.25};
  for (const bool is_left : {true, false}) {
    const Values scene = is_left ? joined(truth, soft) : joined(soft, truth);
    Colours colours;
    std::vector<std::uint8_t> grey;
    for (const double value : scene) {
      const double level = std::clamp(value, 0.0, 255.0);
      for (const double part : parts)
        colours.bits8.push_back(static_cast<std::uint8_t>(std::lround(part * level)));
      grey.push_back(static_cast<std::uint8_t>(
          std::lround(level * (0.299 + 0.587 * parts[1] + 0.114 * parts[2]))));
    }
    picture.add(is_left ? 0 : 1, Frame(kWidth, kHeight, std::move(grey)), colours);
  }
  const Sharp sharp = picture.finish();
  ASSERT_EQ(sharp.colours.bits8.size(), 3 * kPixels);
  for (int c = 0; c < 3; ++c) {
    std::vector<std::uint8_t> channel;
    for (std::size_t i = 0; i < kPixels; ++i) channel.push_back(sharp.colours.bits8[3 * i + c]);
    EXPECT_LT(rms(channel, truth, parts[c], 12), 2) << c;
  }
  const std::uint8_t* const pixel = &sharp.colours.bits8[3 * 1234];
  EXPECT_NEAR(greys_of(sharp.grey)[1234], 0.299 * pixel[0] + 0.587 * pixel[1] + 0.114 * pixel[2],
              0.51);
}

TEST(Sharp, FollowsAFrameToWhereItLies) {
  const Values truth = texture(6);
  const Frame frame(kWidth, kHeight, exposed<std::uint8_t>(truth, 1, 0, 1));
  const Similarity away{.scale = 1, .angle_rad = 0, .dx_px = 3, .dy_px = -2};
  const Frame moved = depth::placed(frame, {}, away).grey;  // what stands at p + away
  EXPECT_EQ(moved.at(100, 50), frame.at(103, 48));
  SharpPicture picture(kWidth, kHeight, Depth::bits8, false);
  picture.add(0, moved, {}, {.scale = 1, .angle_rad = 0, .dx_px = -3, .dy_px = 2});
  const Sharp sharp = picture.finish();
  for (int x = 10; x < 200; ++x) EXPECT_EQ(sharp.grey.at(x, 60), frame.at(x, 60));
}

TEST(Placed, TurnsAndGrowsAboutTheMiddle) {
  Values waves(kPixels);
  const auto wave = [](double x, double y) { return 128 + 90 * std::sin(0.2 * x + 0.13 * y); };
  for (std::size_t i = 0; i < kPixels; ++i)
    waves[i] = wave(static_cast<double>(i % kWidth), static_cast<double>(i / kWidth));
  const Frame frame(kWidth, kHeight, exposed<std::uint16_t>(waves, 100, 0, 1));
  const Similarity place{.scale = 1.03, .angle_rad = 0.02, .dx_px = 1.3, .dy_px = -0.6};
  const Frame seen = depth::placed(frame, {}, place).grey;
  const double cx = (kWidth - 1) / 2.0, cy = (kHeight - 1) / 2.0;
  for (int y = 20; y < kHeight - 20; y += 7) {
    for (int x = 20; x < kWidth - 20; x += 7) {
      const double u = x - cx, v = y - cy;
      const double sx = cx + 1.03 * (std::cos(0.02) * u - std::sin(0.02) * v) + 1.3;
      const double sy = cy + 1.03 * (std::sin(0.02) * u + std::cos(0.02) * v) - 0.6;
      EXPECT_NEAR(seen.at(x, y) / 100.0, wave(sx, sy), 0.3);
    }
  }
}

TEST(Sharp, RefusesWhatDoesNotBelongToIt) {
  SharpPicture picture(32, 32, Depth::bits8, true);
  const Frame grey(32, 32, std::vector<std::uint8_t>(32 * 32));
  EXPECT_THROW(picture.add(0, grey, {}), Error);
  EXPECT_THROW(picture.add(0, Frame(32, 31, std::vector<std::uint8_t>(32 * 31)), {}), Error);
  EXPECT_THROW(picture.finish(), Error);
  EXPECT_THROW(SharpPicture(0, 5, Depth::bits8, false), Error);
}

TEST(Sharp, TakesPicturesOfAnySize) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {5, 70}, {64, 1}, {17, 65}}) {
    std::vector<std::uint8_t> samples(std::size_t{1} * width * height);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<std::uint8_t>(i * 37);
    SharpPicture picture(width, height, Depth::bits8, false);
    picture.add(0, Frame(width, height, samples), {});
    const Sharp sharp = picture.finish();
    EXPECT_EQ(sharp.grey.at(width - 1, height - 1), samples.back());
    EXPECT_EQ(sharp.frame.size(), samples.size());
  }
}

}  // namespace
}  // namespace fathom
