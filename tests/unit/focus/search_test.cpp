// SPDX-License-Identifier: Apache-2.0
#include "focus/search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "focus/searches.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using test::expect_error;

/// A motor with whole steps.
double whole_steps(double position) { return std::round(position); }
double anywhere(double position) { return position; }

Objective quadratic(double peak, std::function<double(double)> nearest) {
  return {[peak](double p) { return 10 - (p - peak) * (p - peak) / 1e5; }, std::move(nearest)};
}

// Thesis T11: "several quadratic equations were used to verify the search".
TEST(GoldenSection, FindsThePeakOfQuadratics) {
  for (const double peak : {3.0, 101.0, 560.4, 953.0, 1197.0}) {
    SearchTrace trace(quadratic(peak, anywhere));
    golden_section(trace, {0, 458, 1200}, 2);
    EXPECT_NEAR(best_of(trace.evaluations()).position, peak, 2) << "peak at " << peak;
  }
}

TEST(GoldenSection, OnWholeStepsEndsWithinTheToleranceOfThePeak) {
  for (int peak = 600; peak <= 1000; peak += 7) {
    SearchTrace trace(quadratic(peak, whole_steps));
    golden_section(trace, {peak - 83.0, peak + 11.0, peak + 121.0}, 2);
    EXPECT_NEAR(best_of(trace.evaluations()).position, peak, 2) << "peak at " << peak;
  }
}

// thesis.md: 7 to 11 evaluations mean a starting bracket of 58 to 400 steps.
TEST(GoldenSection, NeedsSevenToElevenEvaluationsFromTheThesisBrackets) {
  for (const double width : {60.0, 100.0, 200.0, 400.0}) {
    SearchTrace trace(quadratic(703, whole_steps));
    golden_section(trace, {703 - 0.45 * width, 703 - 0.07 * width, 703 + 0.55 * width}, 2);
    EXPECT_GE(trace.evaluations().size(), 7u) << width;
    EXPECT_LE(trace.evaluations().size(), 12u) << width;
  }
}

TEST(GoldenSection, FirstEvaluatesTheInnerPointAndOneInTheLargerSegment) {
  SearchTrace trace(quadratic(50, anywhere));
  golden_section(trace, {0, 20, 100}, 99);
  ASSERT_GE(trace.evaluations().size(), 2u);
  EXPECT_EQ(trace.evaluations()[0].position, 20);
  EXPECT_NEAR(trace.evaluations()[1].position, 20 + 0.381966 * 80, 1e-4);
}

TEST(GoldenSection, KeepsTheThesisArrays) {
  SearchTrace trace(quadratic(420, whole_steps));
  golden_section(trace, {300, 400, 600}, 2);
  int loop = 0;
  for (const Evaluation& e : trace.evaluations()) {
    EXPECT_EQ(e.loop, ++loop);
    EXPECT_EQ(e.score, 10 - (e.position - 420) * (e.position - 420) / 1e5);
  }
}

TEST(GoldenSection, RefusesAToleranceThatNeverEnds) {
  SearchTrace trace(quadratic(5, anywhere));
  EXPECT_THROW(golden_section(trace, {0, 5, 10}, 0), Error);
  EXPECT_THROW(golden_section(trace, {0, 5, 10}, std::numeric_limits<double>::quiet_NaN()), Error);
}

TEST(SearchTrace, EvaluatesNoPositionTwice) {
  int calls = 0;
  SearchTrace trace({[&](double) { return static_cast<double>(++calls); }, whole_steps});
  EXPECT_EQ(trace.score_at(10.2), 1);
  EXPECT_EQ(trace.score_at(9.9), 1);
  EXPECT_EQ(trace.score_at(11), 2);
  EXPECT_EQ(calls, 2);
}

TEST(SearchTrace, RefusesAScoreThatIsNotANumber) {
  SearchTrace trace({[](double) { return std::nan(""); }, anywhere});
  EXPECT_THROW(trace.score_at(1), Error);
}

TEST(GoldenSection, EndsAlsoWhereDoublesDo) {
  SearchTrace trace(quadratic(950, anywhere));
  golden_section(trace, {900, 930, 1000}, 1e-300);
  // A parabola is flat to the last bit within the root of its own precision.
  EXPECT_NEAR(best_of(trace.evaluations()).position, 950, 1e-3);
  EXPECT_LT(trace.evaluations().size(), 100u);
}

double gaussian(double p, double peak) { return 0.1 + std::exp2(-std::pow((p - peak) / 30, 2)); }

Objective smooth_peak(double peak) {
  return {[peak](double p) { return gaussian(p, peak); }, anywhere};
}

TEST(FibonacciSection, EndsWithinTheToleranceOfThePeak) {
  for (const double tolerance : {0.1, 2.0, 7.0, 60.0}) {
    for (double peak = 101; peak < 200; peak += 3.7) {
      // Of one peak, but no symmetry, and no slope that leads on.
      const Objective skew{[peak](double p) { return p < peak ? p : 2 * peak - 5 * (p - peak); },
                           anywhere};
      SearchTrace trace(skew);
      fibonacci_section(trace, 100, 200, tolerance);
      EXPECT_NEAR(best_of(trace.evaluations()).position, peak, tolerance * (1 + 1e-9)) << peak;
    }
  }
}

// Both end with the peak between the neighbours of the best; fibonacci knows beforehand how.
TEST(FibonacciSection, NeedsNoMoreEvaluationsThanGolden) {
  for (const double tolerance : {0.3, 1.0, 2.0, 5.0}) {
    for (double peak = 105; peak < 200; peak += 9.1) {
      SearchTrace fibonacci(smooth_peak(peak)), golden(smooth_peak(peak));
      fibonacci_section(fibonacci, 100, 200, tolerance);
      golden_section(golden, whole_range(100, 200), tolerance);
      EXPECT_LE(fibonacci.evaluations().size(), golden.evaluations().size()) << tolerance;
    }
  }
}

TEST(FibonacciSection, LooksAtNoPlaceTwice) {
  SearchTrace trace(smooth_peak(143));
  fibonacci_section(trace, 100, 200, 1);
  const auto curve = trace.curve();
  for (std::size_t i = 1; i < curve.size(); ++i)
    EXPECT_GT(curve[i].position - curve[i - 1].position, 0.1);
}

TEST(Brent, NeedsFewerEvaluationsThanGoldenOnASmoothPeak) {
  std::size_t brents = 0, goldens = 0;
  for (double peak = 110; peak < 190; peak += 3.3) {
    SearchTrace one(smooth_peak(peak)), other(smooth_peak(peak));
    brent(one, 100, 200, 0.1);
    golden_section(other, whole_range(100, 200), 0.1);
    EXPECT_NEAR(best_of(one.evaluations()).position, peak, 0.1);
    brents += one.evaluations().size();
    goldens += other.evaluations().size();
  }
  EXPECT_LT(3 * brents, 2 * goldens) << "the thesis hoped for a third fewer (T16)";
}

TEST(HillClimb, StopsWhereItIsHighestAndStaysInside) {
  for (const double peak : {-50.0, 3.0, 47.2, 99.0, 160.0}) {
    SearchTrace trace(smooth_peak(peak));
    hill_climb(trace, 40, 16, 0, 100, 1);
    EXPECT_NEAR(best_of(trace.evaluations()).position, std::clamp(peak, 0.0, 100.0), 1) << peak;
    EXPECT_GE(trace.curve().front().position, 0);
    EXPECT_LE(trace.curve().back().position, 100);
  }
}

TEST(HillClimb, EndsWhereTheLensDoes) {
  for (const double resolution : {1.0, 0.25, 1e-12}) {
    SearchTrace trace({[](double p) { return 1 / (1 + p * p); },
                       [=](double p) { return std::round(p / resolution) * resolution; }});
    hill_climb(trace, -7, 4, -10, 10, std::numeric_limits<double>::denorm_min());
    EXPECT_NEAR(best_of(trace.evaluations()).position, 0, 2 * resolution);
    EXPECT_LT(trace.evaluations().size(), 200U);
  }
}

TEST(Sections, RefuseAToleranceThatNeverEnds) {
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    SearchTrace trace(smooth_peak(5));
    EXPECT_THROW(fibonacci_section(trace, 0, 10, bad), Error);
    EXPECT_THROW(brent(trace, 0, 10, bad), Error);
    EXPECT_THROW(hill_climb(trace, 5, 1, 0, 10, bad), Error);
    EXPECT_TRUE(trace.evaluations().empty());
  }
}

TEST(Sections, TakeAnIntervalOfNoLength) {
  SearchTrace trace(quadratic(5, whole_steps));
  fibonacci_section(trace, 7, 7, 2);
  brent(trace, 7, 7, 2);
  golden_section(trace, {7, 7, 7}, 2);
  hill_climb(trace, 7, 5, 7, 7, 2);
  EXPECT_EQ(trace.evaluations().size(), 1u);
}

TEST(Searches, EachIsFoundByItsNameAndByItsMethod) {
  for (const Search& search : searches()) {
    EXPECT_EQ(parse_search_method(search.name), search.method);
    EXPECT_STREQ(to_string(search.method), search.name);
    EXPECT_EQ(&search_of(search.method), &search);
  }
  expect_error(ErrorCode::bad_argument, [] { parse_search_method("Golden"); },
               {"\"Golden\"", "auto, golden, fibonacci, brent, hill, full"});
}

TEST(BracketAroundBest, TakesTheNeighboursByPosition) {
  const std::vector<Evaluation> e = {{1, 0, 1}, {2, 300, 2}, {3, 100, 5}, {4, 200, 9}};
  EXPECT_EQ(bracket_around_best(e), (Bracket{100, 200, 300}));
}

TEST(BracketAroundBest, AtAnEndIsOneSided) {
  const std::vector<Evaluation> falling = {{1, 0, 9}, {2, 100, 5}, {3, 200, 1}};
  const Bracket bracket = bracket_around_best(falling);
  EXPECT_EQ(bracket.low, 0);
  EXPECT_EQ(bracket.high, 100);
  EXPECT_GT(bracket.inner, 0);
  EXPECT_LT(bracket.inner, 100);
}

TEST(ParseBracket, ReadsThreeIncreasingNumbers) {
  EXPECT_EQ(parse_bracket("600,700.5,800"), (Bracket{600, 700.5, 800}));
  for (const char* bad :
       {"", "1,2", "1,2,3,4", "3,2,1", "1,1,2", "a,b,c", "1,2,nan", "1, 2,3", "1,2,3x"}) {
    EXPECT_THROW(parse_bracket(bad), Error) << bad;
  }
}

}  // namespace
}  // namespace fathom
