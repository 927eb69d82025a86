// SPDX-License-Identifier: Apache-2.0
#include "focus/curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "engine/error.hpp"

namespace fathom {
namespace {

FocusCurve curve_of(const std::vector<double>& scores) {
  std::vector<Evaluation> evaluations;
  for (const double score : scores)
    evaluations.push_back(
        {static_cast<int>(evaluations.size()) + 1, static_cast<double>(evaluations.size()), score});
  return FocusCurve(std::move(evaluations));
}

TEST(FocusCurve, IsSortedByPositionAndKeepsTheOrderOfEquals) {
  const FocusCurve curve({{1, 300, 5}, {2, 100, 7}, {3, 300, 6}, {4, 200, 1}});
  const std::vector<Evaluation> sorted = {{2, 100, 7}, {4, 200, 1}, {1, 300, 5}, {3, 300, 6}};
  EXPECT_EQ(curve.evaluations(), sorted);
  EXPECT_EQ(curve.front(), sorted.front());
  EXPECT_EQ(curve.back(), sorted.back());
  EXPECT_EQ(curve[1], sorted[1]);
  EXPECT_EQ(curve.size(), 4u);
}

TEST(FocusCurve, ItsBestIsTheFirstOfEquals) {
  EXPECT_EQ(curve_of({1, 9, 3, 9}).best(), 1u);
  EXPECT_EQ(curve_of({1, 9, 3, 9}).top(), (Evaluation{2, 1, 9}));
  EXPECT_EQ(curve_of({0, 0, 0}).best(), 0u);
}

TEST(FocusCurve, ItsFloorIsWhatAFifthLiesBelow) {
  std::vector<double> scores;
  for (int i = 1; i <= 11; ++i) scores.push_back(i);
  std::shuffle(scores.begin(), scores.end(), std::mt19937(7));
  EXPECT_EQ(curve_of(scores).floor(), 3);  // 2 of the 11 lie below
  EXPECT_EQ(curve_of(scores).height(), 8);
}

TEST(FocusCurve, DeadPicturesAreNoFloor) {
  const FocusCurve curve = curve_of({0, 2, 4, 1e-9, 2, -1});
  EXPECT_EQ(curve.dead(), 3u);
  EXPECT_EQ(curve.live().size(), 3u);
  for (const Evaluation& e : curve.live()) EXPECT_GE(e.score, 2);
  EXPECT_EQ(curve.floor(), 2);
  EXPECT_EQ(curve.size(), 6u);
}

TEST(FocusCurve, OfNothingButDeadPicturesHasNoFloor) {
  const FocusCurve curve = curve_of({0, 0});
  EXPECT_EQ(curve.floor(), 0);
  EXPECT_TRUE(curve.live().empty());
  EXPECT_EQ(curve.dead(), 2u);
  EXPECT_EQ(curve.height(), 0);
}

TEST(FocusCurve, MayBeEmpty) {
  for (const FocusCurve& curve : {FocusCurve(), FocusCurve(std::vector<Evaluation>())}) {
    EXPECT_TRUE(curve.empty());
    EXPECT_EQ(curve.floor(), 0);
    EXPECT_EQ(curve.best(), 0u);
  }
}

// Light multiplies all scores: what is live, the best and, up to the factor, the floor stay.
TEST(FocusCurve, DoesNotDependOnTheLight) {
  const std::vector<double> scores = {1, 3, 0, 8, 2, 1e-6, 5};
  const FocusCurve one = curve_of(scores);
  for (const double light : {0x1p-40, 0x1p60}) {
    auto other = scores;
    for (double& score : other) score *= light;
    const FocusCurve curve = curve_of(other);
    EXPECT_EQ(curve.floor(), one.floor() * light);
    EXPECT_EQ(curve.best(), one.best());
    EXPECT_EQ(curve.dead(), one.dead());
  }
}

TEST(BestOf, IsTheEarliestOfEqualsInAnyOrder) {
  const std::vector<Evaluation> e = {{1, 100, 3}, {2, 50, 9}, {3, 10, 9}};
  EXPECT_EQ(best_of(e).loop, 2);
  EXPECT_THROW(best_of({}), Error);
}

}  // namespace
}  // namespace fathom
