// SPDX-License-Identifier: Apache-2.0
// Pictures of a lens that goes on: the law of their smear, and the search on the way.
#include "focus/spectral_travel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "focus/focus.hpp"
#include "tests/unit/focus/defocused_object.hpp"

namespace fathom {
namespace {

using test::DefocusedObject;

constexpr BlurModel kModel{.px_per_unit = 0.08};
constexpr SpectralRange kTravel{0, 1200};

/// Of a lens that is always looked at `misplaced` beside where it is said to be.
Evaluation passed(const DefocusedObject& object, double position, const OnTheWay& way,
                  std::mt19937& random, double misplaced = 0) {
  Evaluation e = object.passing(position + misplaced, way.smear, random);
  e.position = position;
  e.on_the_way = way;
  return e;
}

std::vector<Evaluation> at_rest(std::vector<Evaluation> evaluations) {
  for (Evaluation& e : evaluations) e.on_the_way.reset();
  return evaluations;
}

// The mean of the picture, not of its power: where the transfer changes its sign, light cancels out.
TEST(DefocusLaw, TheAmplitudesOfAMeanAddUp) {
  const DefocusLaw& law = DefocusLaw::of(64, BlurShape::disc);
  const auto& radii = DefocusedObject::radii_of(64);
  const std::vector<double> diameters = {1, 3, 6}, weights = {0.25, 0.25, 0.5};
  std::vector<float> squared(law.rings());
  law.transfer_of_mean(diameters, weights, squared);
  for (int k = 0; k < law.rings(); ++k)
    EXPECT_NEAR(squared[k], radii.transfer(k, diameters, weights), 2e-3) << k;
}

TEST(SpectralFit, ASmearedPictureIsHeldAgainstTheSmearedLaw) {
  std::mt19937 random(40);
  for (unsigned i = 0; i < 12; ++i) {
    const DefocusedObject object{.focus = 600, .seed = i};
    const OnTheWay way{.sigma = 0, .smear = 60};  // nearly 5 px
    std::vector<Evaluation> seen;
    for (const double position : {500.0, 545.0, 590.0, 640.0, 700.0})
      seen.push_back(passed(object, position, way, random));
    const SpectralFit fit = fit_spectra(seen, 64, kModel, kTravel);
    EXPECT_TRUE(is_sure(fit)) << i;
    EXPECT_NEAR(fit.position, object.focus, 4 * fit.sigma) << i;
    const SpectralFit blind = fit_spectra(at_rest(seen), 64, kModel, kTravel);
    EXPECT_GT(blind.misfit, 2 * fit.misfit) << "without its smear it is no such picture";
  }
}

// Play that nobody knows misplaces all pictures of a way alike.
TEST(SpectralFit, WhatIsNotKnownOfAPlaceIsInSigma) {
  std::mt19937 random(41);
  std::normal_distribution<double> aside(0, 12);
  int sure = 0;
  double squares = 0;
  constexpr int kCases = 60;
  for (unsigned i = 0; i < kCases; ++i) {
    const DefocusedObject object{.focus = 600, .seed = i};
    const OnTheWay way{.sigma = 12, .smear = 1};
    std::vector<Evaluation> seen;
    const double misplaced = aside(random);
    for (const double position : {520.0, 550.0, 580.0, 610.0, 640.0, 670.0})
      seen.push_back(passed(object, position, way, random, misplaced));
    const SpectralFit fit = fit_spectra(seen, 64, kModel, kTravel);
    if (!is_sure(fit)) continue;
    ++sure;
    squares += std::pow((fit.position - object.focus) / fit.sigma, 2);
  }
  EXPECT_GE(sure, kCases / 2);
  EXPECT_GT(std::sqrt(squares / sure), 0.4);
  EXPECT_LT(std::sqrt(squares / sure), 1.4);
}

/// A lens and a camera as the law has them: every `frame` units a picture, of so much smear.
class Rail {
 public:
  explicit Rail(const DefocusedObject& object, double frame = 1, double smear = 1)
      : object_(object), frame_(frame), smear_(smear) {}

  Objective objective() {
    return {.score = [this](double position) -> Sample {
              travelled += std::abs(position - here);
              here = position;
              ++halts;
              return sample(object_.at(position, random_));
            },
            .nearest = [](double wanted) { return std::round(wanted); },
            .travel = [this](double to, double apart,
                             const PictureOnTheWay& goes_on) { pass(to, apart, goes_on); }};
  }

  double here = 0, travelled = 0;
  int halts = 0, turns = 0;
  std::optional<double> halts_at;  ///< Nobody knows where pictures are of from here on.

 private:
  Sample sample(const Evaluation& e) const {
    const double away = (e.position - object_.focus) / 30;
    return {1e-3 + 1 / (1 + away * away), e.picture, e.on_the_way};
  }

  void pass(double to, double apart, const PictureOnTheWay& goes_on) {
    const double way = to > here ? frame_ : -frame_, from = here;
    if (from != 0 && way * last_way_ < 0) ++turns;
    last_way_ = way;
    double last = here;
    for (double place = from + way; (to - place) * way > 0; place += way) {
      travelled += std::abs(way);
      here = place;
      if (std::abs(place - last) < apart) continue;
      last = place;
      if (halts_at && (place - *halts_at) * way > 0) {
        goes_on(std::round(place), sample(object_.at(place, random_)));
        return;
      }
      const Evaluation e = passed(object_, place, {.sigma = 0.3, .smear = smear_}, random_);
      if (!goes_on(place, sample(e))) return;
    }
    travelled += std::abs(to - here);
    here = to;
  }

  DefocusedObject object_;
  double frame_, smear_;
  std::mt19937 random_{42};
  double last_way_ = 0;
};

/// Of a search on the way from where the lens stands, up to `to` of a travel of 1200.
FocusLimits limits_from(const Rail& rail, double to = 1200) {
  FocusLimits limits;
  limits.to = to;
  limits.highest = 1200;
  limits.start = rail.here;
  limits.blur = kModel;
  limits.moves = true;
  return limits;
}

Focus search(Rail& rail, double start) {
  rail.here = start;
  FocusLimits limits = limits_from(rail);
  limits.is_live = true;
  for (double position = 0; position <= 1200; position += 100)
    limits.coarse.positions.push_back(position);
  return search_focus(rail.objective(), limits, MetricSpec::parse("fft:64"), 0.01);
}

TEST(SpectralTravel, GoesNearlyTheDirectWayAndHaltsOnlyAtTheEnd) {
  for (const double start : {20.0, 300.0, 1150.0}) {
    Rail rail({.focus = 700});
    const Focus focus = search(rail, start);
    EXPECT_EQ(focus.spectral_end, SpectralEnd::found) << start;
    EXPECT_EQ(focus.result(), FocusResult::focused) << start;
    EXPECT_NEAR(focus.position(), 700, 4 * focus.peak.sigma) << start;
    EXPECT_LT(rail.travelled, std::abs(700 - start) + 130) << start;
    EXPECT_LE(rail.halts, 15) << start;
    for (const Evaluation& e : focus.evaluations) EXPECT_FALSE(e.on_the_way) << "in the curve";
  }
}

// The wider part of the travel is above, the focus below: where the lens goes, pictures get worse.
TEST(SpectralTravel, TurnsRoundWhenTheFocusIsBehind) {
  for (const double start : {400.0, 520.0}) {
    Rail rail({.focus = 250});
    const Focus focus = search(rail, start);
    EXPECT_EQ(focus.result(), FocusResult::focused) << start;
    EXPECT_NEAR(focus.position(), 250, 4 * focus.peak.sigma) << start;
    EXPECT_EQ(rail.turns, 1) << start;
    EXPECT_LT(rail.travelled, start - 250 + 260) << start;
  }
}

TEST(SpectralTravel, HaltsWherePicturesOnTheWayAreOfNoUse) {
  Rail smeared({.focus = 700}, 1, 40), rare({.focus = 700}, 90, 1), lost({.focus = 700});
  lost.halts_at = 330;
  for (Rail* rail : {&smeared, &rare, &lost}) {
    const Focus focus = search(*rail, 300);
    EXPECT_EQ(focus.spectral_end, SpectralEnd::found);
    EXPECT_EQ(focus.result(), FocusResult::focused);
    EXPECT_NEAR(focus.position(), 700, 4 * focus.peak.sigma);
    EXPECT_LT(rail->travelled, 700) << "it did not go on for nothing";
    EXPECT_GE(rail->halts, 11);
  }
}

TEST(SpectralTravel, FindsNoFocusWhereThereIsNone) {
  for (const DefocusedObject& object :
       {DefocusedObject{.contrast = 0, .noise = 2}, DefocusedObject{.px_per_unit = 1e-6}}) {
    Rail rail(object);
    rail.here = 500;
    SearchTrace trace(rail.objective());
    EXPECT_EQ(spectral_search(trace, limits_from(rail)), SpectralEnd::nothing_changes);
    EXPECT_LT(rail.travelled, 400);
  }
}

TEST(SpectralTravel, SaysBeyondWhereTheFocusIsNotWithinItsLimits) {
  Rail rail({.focus = 900});
  rail.here = 300;
  SearchTrace trace(rail.objective());
  EXPECT_EQ(spectral_search(trace, limits_from(rail, 600)), SpectralEnd::beyond_travel);
  EXPECT_LE(rail.here, 600);
}

}  // namespace
}  // namespace fathom
