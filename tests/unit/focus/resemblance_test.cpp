// SPDX-License-Identifier: Apache-2.0
#include "focus/resemblance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "focus/focus.hpp"
#include "tests/support/grain.hpp"

namespace fathom::test {
namespace {

constexpr int kSide = 64, kAround = 20;

Patch patch_of(const std::vector<double>& greys, int side) {
  return {side, side, std::vector<float>(greys.begin(), greys.end())};
}

/// The square of kSide pixels at (x, y) of a larger one.
Patch cut(const std::vector<double>& greys, int side, int x, int y) {
  Patch patch{kSide, kSide, {}};
  for (int row = y; row < y + kSide; ++row) {
    for (int i = x; i < x + kSide; ++i)
      patch.greys.push_back(static_cast<float>(greys[row * side + i]));
  }
  return patch;
}

class Noise : public ::testing::TestWithParam<int> {};

TEST_P(Noise, ResemblesNoOther) {
  constexpr int kLarge = kSide + 2 * kAround;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Grains grains(seed);
    const Patch one = patch_of(grains.smooth(kSide, GetParam()), kSide);
    const Patch other = patch_of(grains.smooth(kLarge, GetParam()), kLarge);
    const auto found = compare(one, other, kAround, kAround, kAround);
    ASSERT_TRUE(found) << seed;
    EXPECT_LT(found->evidence, kEvident) << seed;
    EXPECT_GT(found->evenness, kEven) << seed;
  }
}
INSTANTIATE_TEST_SUITE_P(Blurs, Noise, ::testing::Values(0, 1, 3, 6));

TEST(Resemblance, FindsATextureThatHasShifted) {
  constexpr int kLarge = kSide + 2 * kAround;
  Grains grains(7);
  const std::vector<double> scene = grains.smooth(kLarge, 2);
  std::vector<double> again = scene;
  for (double& grey : again) grey += 0.3 * grains.next();
  const Patch other = patch_of(again, kLarge);
  for (const auto& [dx, dy] : {std::pair(0, 0), {9, -7}, {-14, 12}}) {
    const Patch here = cut(scene, kLarge, kAround + dx, kAround + dy);
    EXPECT_GT(compare(here, other, kAround, kAround, kAround)->evidence, kEvident) << dx;
    // Of the other picture no more may be there than the window itself.
    const Patch alone = cut(again, kLarge, kAround, kAround);
    EXPECT_GT(compare(here, alone, 0, 0, kAround)->evidence, kEvident) << dx;
  }
}

TEST(Resemblance, KnowsAWireByItsUnevenness) {
  Grains grains(3);
  std::vector<double> wire = grains.smooth(kSide, 0);
  for (int y = 0; y < kSide; ++y) wire[y * kSide + 30] += 60;
  const auto found =
      compare(patch_of(wire, kSide), patch_of(grains.smooth(kSide, 0), kSide), 0, 0, 4);
  EXPECT_LT(found->evenness, kEven);
  EXPECT_LT(found->evidence, kEvident);
}

TEST(Resemblance, LearnsNothingFromACopyOrAFlatPicture) {
  const Patch noise = patch_of(Grains(5).smooth(kSide, 1), kSide);
  EXPECT_FALSE(compare(noise, noise, 0, 0, 8));
  const Patch flat{kSide, kSide, std::vector<float>(kSide * kSide, 100)};
  EXPECT_FALSE(compare(noise, flat, 0, 0, 8));
  EXPECT_FALSE(compare(flat, noise, 0, 0, 8));
}

Focus doubted(const std::optional<Resemblance>& resemblance, Why why = Why::stands_out) {
  Focus focus;
  focus.verdict.result = FocusResult::focused;
  focus.verdict.confidence = 0.8;
  focus.verdict.reason.why = why;
  doubt_for_resemblance(focus, resemblance);
  return focus;
}

TEST(Resemblance, DecidesWhatIsBelieved) {
  EXPECT_EQ(doubted({}).verdict.confidence, 0.8);
  EXPECT_EQ(doubted(Resemblance{8, 0.9}).verdict.confidence, 0.8);
  const Focus uneven = doubted(Resemblance{2, 0.3});
  EXPECT_EQ(uneven.result(), FocusResult::focused);
  EXPECT_EQ(uneven.verdict.confidence, 0.4);
  const Focus even = doubted(Resemblance{2, 0.9});
  EXPECT_EQ(even.result(), FocusResult::no_focus);
  EXPECT_EQ(even.verdict.reason.why, Why::unshared);
  EXPECT_EQ(even.verdict.confidence, 0);
  EXPECT_EQ(doubted(Resemblance{2, 0.9}, Why::by_spectra).verdict.confidence, 0.8);
}

}  // namespace
}  // namespace fathom::test
