// SPDX-License-Identifier: Apache-2.0
#include "focus/focus.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/error.hpp"
#include "hal/rig_driver.hpp"

namespace fathom {
namespace {

const MetricSpec kFft = MetricSpec::standard(Transform::fft, 64);
const LensInfo kLens{"test lens", "steps", 0, 1200, 1, 100, {}};

/// The thesis rig's kind of curve: half its height at 25 steps, a floor at 0.16.
Objective narrow_peak(double peak) {
  return {[peak](double p) { return 0.16 + 0.84 / (1 + std::pow((p - peak) / 25, 2)); },
          [](double p) { return std::round(p); }};
}

TEST(SearchFocus, FindsANarrowPeakAnywhereOverTheWholeTravel) {
  for (double peak = 40; peak <= 1160; peak += 37) {
    const Focus focus = search_focus(narrow_peak(peak), resolve_limits({}, kLens), kFft, 0.005);
    EXPECT_EQ(focus.result(), FocusResult::focused) << peak;
    EXPECT_NEAR(focus.position(), peak, 0.05) << peak;
    EXPECT_LE(focus.evaluations.size(), 18u) << peak;
  }
}

TEST(SearchFocus, UsesABracketAsTheThesisDid) {
  FocusRequest request;
  request.bracket = Bracket{650, 700, 850};
  request.search = SearchMethod::golden;
  request.peak = PeakMethod::evaluated;
  const Focus focus = search_focus(narrow_peak(731), resolve_limits(request, kLens), kFft, 0.005);
  EXPECT_NEAR(focus.position(), 731, 2);
  EXPECT_EQ(focus.position(), best_of(focus.evaluations).position);
  EXPECT_LE(focus.evaluations.size(), 11u);
  for (const Evaluation& e : focus.evaluations) {
    EXPECT_GT(e.position, 650);
    EXPECT_LT(e.position, 850);
  }
}

TEST(SearchFocus, SaysAtLimitWhenThePeakLiesBeyond) {
  FocusRequest request;
  request.from = 0;
  request.to = 600;
  const Focus focus = search_focus(narrow_peak(640), resolve_limits(request, kLens), kFft, 0.005);
  EXPECT_EQ(focus.result(), FocusResult::at_limit);
  EXPECT_EQ(focus.position(), 600);
}

TEST(ResolveLimits, TakesTheLensWhereNothingIsSaid) {
  const FocusLimits limits = resolve_limits({}, kLens);
  EXPECT_EQ(limits.from, 0);
  EXPECT_EQ(limits.to, 1200);
  EXPECT_EQ(limits.coarse.positions.size(), 13u);
  EXPECT_EQ(limits.tolerance, 2);
}

TEST(CoarsePositions, CoverBothEndsAtNoMoreThanTheSpacing) {
  const auto positions = coarse_positions(kLens, 100, 1150);
  EXPECT_EQ(positions.front(), 100);
  EXPECT_EQ(positions.back(), 1150);
  for (std::size_t i = 1; i < positions.size(); ++i) {
    EXPECT_LE(positions[i] - positions[i - 1], 100 + 1e-9);
  }
  EXPECT_EQ(positions.size(), 12u);
}

TEST(CoarsePositions, AreOnlyStopsWhereThereAreStops) {
  LensInfo lens{"", "um", 0, 1e6, 1e-9, 10, {0, 1e-9, 4, 9, 12, 500, 1e6}};
  EXPECT_EQ(coarse_positions(lens, 0, 1e6), (std::vector<double>{0, 9, 12, 500, 1e6}));
  EXPECT_EQ(coarse_positions(lens, 3, 20), (std::vector<double>{4, 12}));
  EXPECT_EQ(coarse_positions(lens, 20, 30), (std::vector<double>{12}));
  lens.coarse_spacing = 1e-9;
  EXPECT_EQ(coarse_positions(lens, 0, 1e6), lens.stops);
}

TEST(ResolveLimits, RefusesWhatTheLensCannotDo) {
  const auto with = [](auto set) {
    FocusRequest request;
    set(request);
    return request;
  };
  EXPECT_THROW(resolve_limits(with([](auto& r) { r.from = -1; }), kLens), Error);
  EXPECT_THROW(resolve_limits(with([](auto& r) { r.to = 1201; }), kLens), Error);
  EXPECT_THROW(resolve_limits(with([](auto& r) { r.from = 900, r.to = 100; }), kLens), Error);
  EXPECT_THROW(resolve_limits(with([](auto& r) { r.tolerance = 0; }), kLens), Error);
  EXPECT_THROW(resolve_limits(with([](auto& r) { r.from = std::nan(""); }), kLens), Error);
  EXPECT_THROW(resolve_limits(with([](auto& r) {
                                r.bracket = Bracket{1000, 1100, 1300};
                              }),
                              kLens),
               Error);
}

TEST(SweepPositions, IncludeBothEndsAndNoneTwice) {
  const Hardware rig = open_hardware("sim");
  EXPECT_EQ(sweep_positions(rig.lens->info(), 100, 130, 10),
            (std::vector<double>{100, 110, 120, 130}));
  EXPECT_EQ(sweep_positions(rig.lens->info(), 100, 102, 0.5), (std::vector<double>{100, 101, 102}));
  EXPECT_EQ(sweep_positions(rig.lens->info(), 5, 5, 10), (std::vector<double>{5}));
  EXPECT_THROW(sweep_positions(rig.lens->info(), 0, 100, 0), Error);
  EXPECT_THROW(sweep_positions(rig.lens->info(), 0, 100, -1), Error);
  EXPECT_THROW(sweep_positions(rig.lens->info(), 0, 100, 1e-9), Error);
}

}  // namespace
}  // namespace fathom
