// SPDX-License-Identifier: Apache-2.0
// Stacks that grow, turn and shift by known amounts, out of focus and in noise.
#include "depth/align.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "depth/placed.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

constexpr int kWidth = 900, kHeight = 700, kFrames = 9;
constexpr std::size_t kPixels = std::size_t{1} * kWidth * kHeight;

/// White noise that is smoothed along rows and columns; each pass adds half a px^2 of variance.
std::vector<float> smoothed(std::vector<float> values, int passes) {
  std::vector<float> other(kPixels);
  for (int pass = 0; pass < passes; ++pass) {
    for (const std::size_t step : {std::size_t{1}, std::size_t{kWidth}}) {
      for (std::size_t i = 0; i < kPixels; ++i) {
        const float before = i >= step ? values[i - step] : values[i];
        const float after = i + step < kPixels ? values[i + step] : values[i];
        other[i] = 0.25F * (before + 2 * values[i] + after);
      }
      std::swap(values, other);
    }
  }
  return values;
}

Frame frame_of(const std::vector<float>& values) {
  std::vector<std::uint16_t> samples;
  samples.reserve(kPixels);
  for (const float value : values)
    samples.push_back(static_cast<std::uint16_t>(std::clamp(value, 0.0F, 255.0F) * 200 + 0.5F));
  return Frame(kWidth, kHeight, std::move(samples));
}

std::vector<float> values_of(const Frame& frame) {
  std::vector<float> values;
  values.reserve(kPixels);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) values.push_back(static_cast<float>(frame.at(x, y)) / 200);
  }
  return values;
}

/// Texture of many scales, as most surfaces have it.
Frame scene() {
  std::mt19937 random(5);
  std::normal_distribution<float> normal(0, 1);
  std::vector<float> sum(kPixels, 120);
  for (const auto& [passes, weight] : {std::pair{1, 25.0F}, {8, 60.0F}, {40, 150.0F}}) {
    std::vector<float> grain(kPixels);
    for (float& value : grain) value = normal(random);
    grain = smoothed(std::move(grain), passes);
    for (std::size_t i = 0; i < kPixels; ++i) sum[i] += weight * grain[i];
  }
  return frame_of(sum);
}

Similarity inverse(const Similarity& place) {
  const double cosine = std::cos(place.angle_rad) / place.scale;
  const double sine = std::sin(place.angle_rad) / place.scale;
  return {.scale = 1 / place.scale,
          .angle_rad = -place.angle_rad,
          .dx_px = -(cosine * place.dx_px + sine * place.dy_px),
          .dy_px = -(cosine * place.dy_px - sine * place.dx_px)};
}

/// The largest distance between where two similarities put the corners, px.
double apart(const Similarity& a, const Similarity& b) {
  double most = 0;
  for (const double x : {0.0, kWidth - 1.0}) {
    for (const double y : {0.0, kHeight - 1.0}) {
      const depth::Point p = depth::place_of(a, x, y, kWidth, kHeight);
      const depth::Point q = depth::place_of(b, x, y, kWidth, kHeight);
      most = std::max(most, std::hypot(p.x - q.x, p.y - q.y));
    }
  }
  return most;
}

/// The scene where `place` puts it, out of focus by how far the frame is from the middle one, with
/// noise.
Frame taken(const Frame& scene, const Similarity& place, int frame, float noise) {
  const Frame moved = depth::placed(scene, {}, inverse(place)).grey;
  std::vector<float> values = smoothed(values_of(moved), 3 * std::abs(frame - kFrames / 2));
  std::mt19937 random(static_cast<unsigned>(frame) + 101);  // none that the scene was made of
  std::normal_distribution<float> normal(0, 1);
  for (float& value : values)
    value = (0.9F + 0.02F * static_cast<float>(frame)) * value + noise * normal(random);
  return frame_of(values);
}

/// The farthest that any frame's place is from the truth, at the corners, px.
double worst(Alignment alignment, const Similarity& last, float noise,
             const std::optional<GrowthLaw>& law = std::nullopt) {
  static const Frame picture = scene();
  StackAligner aligner(alignment, law);
  double most = 0;
  for (int z = 0; z < kFrames; ++z) {
    const double part = static_cast<double>(z) / (kFrames - 1);
    const Similarity place{.scale = 1 + part * (last.scale - 1),
                           .angle_rad = part * last.angle_rad,
                           .dx_px = part * last.dx_px,
                           .dy_px = part * last.dy_px};
    most = std::max(most, apart(aligner.add(taken(picture, place, z, noise)), place));
  }
  return most;
}

TEST(StackAligner, FollowsAPictureThatGrowsByThreePercent) {
  const Similarity last{.scale = 1.03, .angle_rad = 0, .dx_px = 0, .dy_px = 0};
  EXPECT_LT(worst(Alignment::scale, last, 1), 0.03);
  EXPECT_LT(worst(Alignment::scale, last, 4), 0.05);
  EXPECT_LT(worst(Alignment::similarity, last, 1), 0.1);
}

/// What a calibration says, so many times too large; frames lie 10 apart, from 500 on.
GrowthLaw law_of(double told_times) {
  constexpr double kTrue = 0.03 / (10 * (kFrames - 1));
  GrowthLaw law{.per_unit = told_times * kTrue, .sigma = 0.1 * kTrue};
  for (int z = 0; z < kFrames; ++z) law.positions.push_back(500 + 10 * z);
  return law;
}

TEST(StackAligner, FollowsTheLawOfALensByOneNumber) {
  const Similarity last{.scale = 1.03, .angle_rad = 0, .dx_px = 0, .dy_px = 0};
  EXPECT_LT(worst(Alignment::scale, last, 1, law_of(0.9)), 0.03);
  EXPECT_LT(worst(Alignment::scale, last, 4, law_of(1.1)), 0.05);
  // A law of another lens is found out.
  for (const double told : {-1.0, 2.0})
    EXPECT_LT(worst(Alignment::scale, last, 1, law_of(told)), 0.1) << told;
}

TEST(StackAligner, TakesTheLawWherePicturesTellNothing) {
  StackAligner aligner(Alignment::scale, law_of(1));
  const Frame blank(kWidth, kHeight, std::vector<std::uint8_t>(kPixels, 90));
  Similarity place;
  for (int z = 0; z < kFrames; ++z) place = aligner.add(blank);
  EXPECT_NEAR(place.scale, 1.03, 1e-6);
  EXPECT_FALSE(StackAligner(Alignment::similarity, law_of(1)).growth_per_unit());
}

TEST(StackAligner, FollowsATurnAndAShift) {
  const Similarity last{.scale = 0.98, .angle_rad = 0.004, .dx_px = 9, .dy_px = -14};
  EXPECT_LT(worst(Alignment::similarity, last, 2), 0.1);
}

/// The left of the picture comes into focus first, the right last, so texture fades to one side and
/// comes up on the other, while the picture grows.
TEST(StackAligner, IsNotPulledByAFocusThatWanders) {
  const Frame picture = scene();
  StackAligner aligner(Alignment::similarity);
  std::vector<std::vector<float>> blurred = {values_of(picture)};
  while (blurred.size() < kFrames) blurred.push_back(smoothed(blurred.back(), 6));
  for (int z = 0; z < kFrames; ++z) {
    std::vector<float> values(kPixels);
    for (std::size_t i = 0; i < kPixels; ++i) {
      const float away =
          std::abs(static_cast<float>(z) - static_cast<float>(i % kWidth) / kWidth * (kFrames - 1));
      const auto near = std::min(static_cast<std::size_t>(away), std::size_t{kFrames - 2});
      const float part = away - static_cast<float>(near);
      values[i] = (1 - part) * blurred[near][i] + part * blurred[near + 1][i];
    }
    const Similarity place{.scale = 1 + 0.03 * z / (kFrames - 1)};
    const Frame moved = depth::placed(frame_of(values), {}, inverse(place)).grey;
    EXPECT_LT(apart(aligner.add(moved), place), 0.1) << "frame " << z;
  }
}

TEST(StackAligner, StandsStillWhereNothingMoves) {
  EXPECT_EQ(worst(Alignment::similarity, {}, 4), 0);
  EXPECT_EQ(worst(Alignment::none, {}, 1), 0);
}

TEST(StackAligner, TakesNoiseForNoMovement) {
  StackAligner aligner(Alignment::similarity);
  for (unsigned z = 0; z < 6; ++z) {
    std::mt19937 random(z + 1);
    std::normal_distribution<float> normal(100, 5);
    std::vector<float> values(kPixels);
    for (float& value : values) value = normal(random);
    EXPECT_EQ(aligner.add(frame_of(values)), Similarity{});
  }
}

TEST(StackAligner, TakesSmallPicturesAndRefusesOtherSizes) {
  StackAligner aligner(Alignment::similarity);
  for (int i = 0; i < 2; ++i)
    EXPECT_EQ(aligner.add(Frame(3, 2, std::vector<std::uint8_t>(6, 9))), Similarity{});
  EXPECT_THROW(aligner.add(Frame(2, 3, std::vector<std::uint8_t>(6))), Error);
}

}  // namespace
}  // namespace fathom
