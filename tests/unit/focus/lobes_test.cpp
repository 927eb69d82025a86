// SPDX-License-Identifier: Apache-2.0
#include "focus/lobes.hpp"

#include <gtest/gtest.h>

namespace fathom {
namespace {

FocusCurve curve_of(const std::vector<double>& scores) {
  std::vector<Evaluation> curve;
  for (const double score : scores)
    curve.push_back(
        {static_cast<int>(curve.size()) + 1, 10.0 * static_cast<double>(curve.size()), score});
  return FocusCurve(std::move(curve));
}

TEST(FindLobes, AreTheHillsTheHighestFirst) {
  const auto curve = curve_of({1, 3, 1, 1, 2, 9, 2, 1, 5, 1});
  const auto lobes = find_lobes(curve, 1);
  ASSERT_EQ(lobes.size(), 3u);
  EXPECT_EQ(lobes[0].best, 5u);
  EXPECT_EQ(lobes[1].best, 8u);
  EXPECT_EQ(lobes[2].best, 1u);
  EXPECT_EQ(lobes[0].height, 8);
  EXPECT_EQ(lobes[0].last, 7u);
  EXPECT_EQ(lobes[1].first, 7u);
  EXPECT_EQ(lobes[1].prominence, 4);
  EXPECT_EQ(lobes[2].first, 0u);
  EXPECT_EQ(lobes[1].last, 9u);
}

TEST(FindLobes, DipsOfLessThanAskedForPartNothing) {
  const auto curve = curve_of({0, 4, 8, 7, 9, 6, 7, 2, 0});
  EXPECT_EQ(find_lobes(curve, 2).size(), 1u);
  EXPECT_EQ(find_lobes(curve, 2)[0].best, 4u);
  EXPECT_EQ(find_lobes(curve, 1).size(), 3u);
}

TEST(FindLobes, SeeAHillAtEitherEnd) {
  const auto lobes = find_lobes(curve_of({5, 1, 0, 2, 9}), 1);
  ASSERT_EQ(lobes.size(), 2u);
  EXPECT_EQ(lobes[0].best, 4u);
  EXPECT_EQ(lobes[0].last, 4u);
  EXPECT_EQ(lobes[1].best, 0u);
}

TEST(FindLobes, ThereIsAlwaysOneWhereThereIsAnEvaluation) {
  EXPECT_TRUE(find_lobes(FocusCurve(), 1).empty());
  EXPECT_EQ(find_lobes(curve_of({3}), 1).size(), 1u);
  EXPECT_EQ(find_lobes(curve_of({3, 3, 3}), 1).size(), 1u);
  EXPECT_EQ(find_lobes(curve_of({9, 5, 1}), 1)[0].best, 0u);
  EXPECT_EQ(find_lobes(curve_of({1, 5, 9}), 1)[0].best, 2u);
}

TEST(FindLobes, AMirroredCurveHasMirroredLobes) {
  const std::vector<double> scores = {1, 3, 1, 1, 2, 9, 2, 1, 5, 1, 0};
  const auto lobes = find_lobes(curve_of(scores), 1);
  const auto mirrored = find_lobes(curve_of({scores.rbegin(), scores.rend()}), 1);
  ASSERT_EQ(mirrored.size(), lobes.size());
  for (std::size_t i = 0; i < lobes.size(); ++i) {
    EXPECT_EQ(mirrored[i].best, scores.size() - 1 - lobes[i].best);
    EXPECT_EQ(mirrored[i].prominence, lobes[i].prominence);
  }
}

TEST(Smoothed, AreRunningMeansThatNarrowTowardsTheEnds) {
  const auto means = smoothed(curve_of({1, 4, 1, 7, 1}), 3);
  const std::vector<double> expected = {1, 2, 4, 3, 1};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(means[i].score, expected[i]) << i;
  EXPECT_EQ(smoothed(curve_of({1, 4}), 1).evaluations(), curve_of({1, 4}).evaluations());
}

}  // namespace
}  // namespace fathom
