// SPDX-License-Identifier: Apache-2.0
// The estimator and the search by spectra on pictures that the law itself makes.
#include "focus/spectral.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "engine/error.hpp"
#include "focus/focus.hpp"
#include "focus/spectral_side.hpp"
#include "focus/spectral_verdict.hpp"
#include "tests/unit/focus/defocused_object.hpp"

namespace fathom {
namespace {

using test::DefocusedObject;

constexpr BlurModel kModel{.px_per_unit = 0.08};
constexpr SpectralRange kTravel{0, 1200};

double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

std::vector<Evaluation> pictures(const DefocusedObject& object, std::vector<double> positions,
                                 std::mt19937& random) {
  std::vector<Evaluation> all;
  for (const double position : positions) all.push_back(object.at(position, random));
  return all;
}

FocusLimits limits_from(double start) {
  FocusLimits limits;
  limits.to = limits.highest = 1200;
  limits.start = start;
  limits.is_live = true;
  limits.blur = kModel;
  return limits;
}

TEST(SpectralFit, ItsSigmaSaysHowFarItIsOff) {
  std::mt19937 random(20);
  double squares = 0;
  int sure = 0;
  constexpr int kCases = 200;
  for (int i = 0; i < kCases; ++i) {
    DefocusedObject object{.focus = uniform(random, 300, 900),
                           .contrast = uniform(random, 10, 60),
                           .noise = uniform(random, 12, 60),
                           .seed = static_cast<unsigned>(i)};
    const double middle = object.focus + uniform(random, -40, 40);
    const auto seen =
        pictures(object, {middle - 60, middle - 20, middle + 20, middle + 60}, random);
    const SpectralFit fit = fit_spectra(seen, 64, kModel, kTravel);
    if (!is_sure(fit)) continue;
    ++sure;
    squares += std::pow((fit.position - object.focus) / fit.sigma, 2);
  }
  EXPECT_GE(sure, kCases / 2);
  // Below 1, for the law holds here: what sigma keeps for lenses that obey it less is not used.
  EXPECT_GT(std::sqrt(squares / sure), 0.6);
  EXPECT_LT(std::sqrt(squares / sure), 1.4);
}

TEST(SpectralFit, BlankPicturesAreNoEvidence) {
  std::mt19937 random(21);
  for (unsigned i = 0; i < 50; ++i) {
    const DefocusedObject blank{.contrast = 0, .noise = uniform(random, 0.5, 20), .seed = i};
    const auto seen = pictures(blank, {500, 540, 600, 620, 700}, random);
    EXPECT_FALSE(is_sure(fit_spectra(seen, 64, kModel, kTravel))) << i;
  }
}

TEST(SpectralFit, NoiseOrLightThatChangesIsNoEvidence) {
  std::mt19937 random(22);
  int by_noise = 0, by_light = 0;
  constexpr unsigned kCases = 50;
  for (unsigned i = 0; i < kCases; ++i) {
    const DefocusedObject blank{.contrast = 0, .noise = 2, .seed = i};
    // Textured, but the lens changes nothing; the lamp does, within its range.
    const DefocusedObject still{.px_per_unit = 1e-6, .noise = 2, .seed = i};
    std::vector<Evaluation> noisy, lit;
    for (double position = 500; position <= 700; position += 40) {
      noisy.push_back(blank.at(position, random, 1, uniform(random, 1, 5)));
      lit.push_back(still.at(position, random, uniform(random, 1, 1.35)));
    }
    by_noise += is_sure(fit_spectra(noisy, 64, kModel, kTravel));
    by_light += is_sure(fit_spectra(lit, 64, kModel, kTravel));
  }
  EXPECT_EQ(by_light, 0);
  // Six pictures may be misled by chance; the search looks on, and is not (below).
  EXPECT_LE(by_noise, 3);
}

TEST(SpectralFit, LightAndNoiseThatChangeLeaveAFocusWhereItIs) {
  std::mt19937 random(23);
  for (unsigned i = 0; i < 30; ++i) {
    const DefocusedObject object{.focus = 610, .seed = i};
    std::vector<Evaluation> seen;
    for (double position = 530; position <= 690; position += 40)
      seen.push_back(
          object.at(position, random, uniform(random, 0.8, 1.3), uniform(random, 0.7, 3)));
    const SpectralFit fit = fit_spectra(seen, 64, kModel, kTravel);
    EXPECT_TRUE(is_sure(fit)) << i;
    EXPECT_NEAR(fit.position, 610, 4 * fit.sigma) << i;
  }
}

/// What only one picture shows, its fine rings, fits any focus: it must not draw the focus to itself.
TEST(SpectralFit, AFocusIsNotDrawnToThePictureBesideIt) {
  std::mt19937 random(35);
  constexpr int kCases = 60;
  double squares = 0, mean = 0;
  for (unsigned i = 0; i < kCases; ++i) {
    const DefocusedObject object{.focus = 600, .noise = 4, .seed = i};
    const auto seen = pictures(object, {790, 750, 600 + uniform(random, 15, 40)}, random);
    const SpectralFit fit = fit_spectra(seen, 64, kModel, kTravel);
    squares += std::pow((fit.position - object.focus) / fit.sigma, 2);
    mean += (fit.position - object.focus) / kCases;
  }
  EXPECT_LT(std::sqrt(squares / kCases), 2);
  EXPECT_LT(mean, 6);
}

TEST(SpectralFit, OrderDoesNotMatter) {
  std::mt19937 random(25);
  auto seen = pictures({}, {530, 570, 610, 650}, random);
  const SpectralFit sorted = fit_spectra(seen, 64, kModel, kTravel);
  // The first picture's light is the measure of the others', and here all are lit alike.
  for (const auto& order : {std::array{3, 1, 0, 2}, std::array{2, 3, 1, 0}}) {
    std::vector<Evaluation> mixed;
    for (const int i : order) mixed.push_back(seen[static_cast<std::size_t>(i)]);
    const SpectralFit fit = fit_spectra(mixed, 64, kModel, kTravel);
    EXPECT_NEAR(fit.position, sorted.position, 0.01 * sorted.sigma);
    EXPECT_NEAR(fit.sigma, sorted.sigma, 0.01 * sorted.sigma);
  }
}

TEST(SpectralFit, NothingIsFittedToNothing) {
  std::mt19937 random(26);
  const DefocusedObject object;
  const auto nothing = [&](std::vector<double> positions, int side) {
    return fit_spectra(pictures(object, std::move(positions), random), side, kModel, kTravel);
  };
  EXPECT_EQ(nothing({}, 64).side, 0);
  EXPECT_EQ(nothing({580}, 64).side, 0);            // one picture
  EXPECT_EQ(nothing({580, 580, 580}, 64).side, 0);  // pictures at one place
  EXPECT_EQ(nothing({560, 640}, 256).side, 0);      // rings of no such window
  EXPECT_EQ(nothing({560, 640}, 16).side, 0);       // a window too small for them
  auto without = pictures(object, {560, 640}, random);
  for (Evaluation& e : without) e.picture.rings.clear();
  EXPECT_EQ(fit_spectra(without, 64, kModel, kTravel).side, 0);
  EXPECT_EQ(ring_sides(without).largest, 0);
}

TEST(SpectralFit, TwoLooksAtOnePlaceCountAsTwoPictures) {
  std::mt19937 random(27);
  const DefocusedObject object{.focus = 600, .noise = 8};
  const auto seen = pictures(object, {560, 560, 640, 640}, random);
  const SpectralFit fit = fit_spectra(seen, 64, kModel, kTravel);
  EXPECT_EQ(fit.pictures, 4);
  EXPECT_NEAR(fit.position, 600, 4 * fit.sigma);
}

TEST(SpectralFit, ABlurThatNoLensHasIsRefused) {
  std::mt19937 random(28);
  const auto seen = pictures({}, {560, 640}, random);
  for (const BlurModel& model :
       {BlurModel{.px_per_unit = 0}, BlurModel{.px_per_unit = -0.08}, BlurModel{.px_per_unit = NAN},
        BlurModel{.px_per_unit = 0.08, .rest_px = -1}}) {
    EXPECT_THROW(fit_spectra(seen, 64, model, kTravel), Error);
    FocusRequest request;
    request.search = SearchMethod::spectral;
    request.blur = model;
    EXPECT_THROW(resolve_limits(request, {"test", "steps", 0, 1200, 1, 100, {}}), Error);
  }
}

TEST(SpectralSearch, FindsTheFocusOnNearlyTheDirectWay) {
  std::mt19937 random(29);
  double travel = 0, direct = 0;
  int found = 0;
  constexpr int kSearches = 40;
  for (unsigned i = 0; i < kSearches; ++i) {
    const DefocusedObject object{.focus = uniform(random, 400, 1050), .seed = i};
    const double start = std::round(uniform(random, 0, 1200));
    SearchTrace trace({[&](double p) {
                         const Evaluation e = object.at(p, random);
                         return Sample(e.score, e.picture);
                       },
                       [](double p) { return std::round(p); }});
    const FocusLimits limits = limits_from(start);
    const SpectralEnd end = spectral_search(trace, limits);
    direct += std::abs(object.focus - start);
    double here = start;
    for (const Evaluation& e : trace.evaluations()) {
      travel += std::abs(e.position - here);
      here = e.position;
    }
    if (end != SpectralEnd::found) continue;
    ++found;
    const SpectralFit fit = fit_all(trace.evaluations(), here, limits);
    EXPECT_NEAR(fit.position, object.focus, 4 * fit.sigma) << i;
    EXPECT_LT(fit.sigma, 2) << i;
  }
  EXPECT_GE(found, kSearches * 95 / 100);
  EXPECT_LT(travel / direct, 1.6);
}

/// The first two pictures lie as far before the focus as behind it, and are alike; those beyond are not.
TEST(SpectralSearch, LooksBetweenTwoPicturesThatAreAlike) {
  std::mt19937 random(35);
  const double half_a_hop = kHopPx / 0.08 / 2;
  int found = 0;
  constexpr int kSearches = 60;
  for (unsigned i = 0; i < kSearches; ++i) {
    const DefocusedObject object{.focus = 600, .contrast = i % 2 == 0 ? 20.0 : 4.0, .seed = i};
    const double start = std::round(600 + half_a_hop + uniform(random, -3, 3));
    SearchTrace trace({[&](double p) { return Sample(1, object.at(p, random).picture); },
                       [](double p) { return std::round(p); }});
    if (spectral_search(trace, limits_from(start)) != SpectralEnd::found) continue;
    ++found;
    double travel = 0, here = start;
    for (const Evaluation& e : trace.evaluations()) {
      travel += std::abs(e.position - here);
      here = e.position;
    }
    EXPECT_LT(travel, 800) << i;
  }
  EXPECT_GE(found, kSearches * 95 / 100);
}

/// What changes from picture to picture is no blur of such a lens, and a coarse pass must follow.
TEST(SpectralSearch, AnotherRigsBlurIsNoticed) {
  std::mt19937 random(24);
  for (const double factor : {3.0, 1 / 3.0}) {
    for (unsigned i = 0; i < 15; ++i) {
      const DefocusedObject object{
          .focus = uniform(random, 400, 1050), .px_per_unit = factor * 0.08, .seed = i};
      SearchTrace trace({[&](double p) { return Sample(1, object.at(p, random).picture); },
                         [](double p) { return std::round(p); }});
      const FocusLimits limits = limits_from(std::round(uniform(random, 0, 1200)));
      EXPECT_NE(spectral_search(trace, limits), SpectralEnd::found) << factor << ", " << i;
    }
  }
}

TEST(SpectralSearch, EndsWithoutAFocusWhereThereIsNone) {
  std::mt19937 random(30);
  for (unsigned i = 0; i < 40; ++i) {
    const DefocusedObject blank{.contrast = 0, .noise = 3, .seed = i};
    const double loudest = i % 2 == 0 ? 3 : 15;  // the camera changes its gain
    SearchTrace trace({[&](double p) {
                         return Sample(1,
                                       blank.at(p, random, 1, uniform(random, 3, loudest)).picture);
                       },
                       [](double p) { return std::round(p); }});
    EXPECT_NE(spectral_search(trace, limits_from(100)), SpectralEnd::found) << i;
  }
  SearchTrace without({[](double) { return Sample(1); }, [](double p) { return p; }});
  EXPECT_EQ(spectral_search(without, limits_from(100)), SpectralEnd::no_spectra);
  EXPECT_EQ(without.evaluations().size(), 1u);
}

/// Where a lens blurs far less than was known, pictures beside a focus look alike. They crowd its top,
/// and would tell the search that follows to look between them.
TEST(SearchFocus, IsNotMisledByPicturesThatAreAlike) {
  std::mt19937 random(32);
  constexpr double kFocus = 600, kHalfWidth = 150, kNoise = 0.002;
  for (unsigned i = 0; i < 20; ++i) {
    const DefocusedObject object{.focus = kFocus, .px_per_unit = 0.08 / 50, .seed = i};
    std::normal_distribution<double> scatter(1, kNoise);
    const Objective objective{
        [&](double p) {
          const double away = (p - kFocus) / kHalfWidth;
          return Sample(scatter(random) * (0.2 + std::exp(-away * away * std::numbers::ln2)),
                        object.at(p, random).picture);
        },
        [](double p) { return std::round(p); }};
    FocusRequest request;
    request.blur = BlurModel{.px_per_unit = 0.08};
    request.start = kFocus + uniform(random, -60, 60);
    const FocusLimits limits =
        resolve_limits(request, {"test", "steps", 0, 1200, 1, kHalfWidth / 2, {}});
    const Focus focus = search_focus(objective, limits, MetricSpec::parse("fft:64"), kNoise);
    ASSERT_EQ(focus.result(), FocusResult::focused) << i;
    EXPECT_EQ(focus.spectral_end, SpectralEnd::nothing_changes) << i;
    EXPECT_NEAR(focus.position(), kFocus, 4 * focus.peak.sigma) << i;
    EXPECT_LT(focus.peak.sigma, 3) << i;
  }
}

TEST(SpectralVerdict, APeakNarrowerThanTheLensMakesIsNotBelieved) {
  Focus focus;
  focus.verdict.result = FocusResult::focused;
  focus.spectral_end = SpectralEnd::found;
  focus.spectral = SpectralFit{.side = 64,
                               .pictures = 8,
                               .position = 600,
                               .sigma = 1.5,
                               .evidence = 500,
                               .misfit = 1,
                               .second_worse = 50};
  const FocusLimits limits = limits_from(0);
  focus.peak = {.position = 603, .sigma = 0.3, .half_width = 2.6};
  heed_spectra(focus, {}, limits);
  EXPECT_EQ(focus.position(), 600);
  EXPECT_EQ(focus.peak.sigma, 1.5);
  focus.peak = {.position = 603, .sigma = 0.3, .half_width = 20};
  heed_spectra(focus, {}, limits);
  EXPECT_GT(focus.position(), 602);  // the mean, by what each is worth
  EXPECT_LT(focus.position(), 603);
  // Where no law tells better, its place is doubted by what the lens could make.
  focus.spectral->evidence = 5;
  focus.spectral->misfit = 0.8;
  focus.peak = {.position = 603, .sigma = 0.3, .half_width = 2.6};
  heed_spectra(focus, {}, limits);
  EXPECT_EQ(focus.position(), 603);
  EXPECT_GT(focus.peak.sigma, 2);
  focus.peak = {.position = 603, .sigma = 0.3, .half_width = 20};
  heed_spectra(focus, {}, limits);
  EXPECT_EQ(focus.peak.sigma, 0.3);
}

/// An object with several depths obeys the law badly, and that goes into sigma, but not where the lens
/// is another than was known.
TEST(SpectralVerdict, WhatObeysTheLawBadlyIsLessSure) {
  Focus focus;
  focus.verdict.result = FocusResult::focused;
  const FocusLimits limits = limits_from(0);
  const auto sigma_of = [&](double misfit, SpectralEnd end) {
    focus.spectral_end = end;
    focus.spectral = SpectralFit{.side = 64, .position = 600, .sigma = 2, .misfit = misfit};
    focus.peak = {.position = 600, .sigma = 0.3, .half_width = 20};
    heed_spectra(focus, {}, limits);
    return focus.peak.sigma;
  };
  EXPECT_EQ(sigma_of(0.8, SpectralEnd::lost), 0.3);
  EXPECT_GT(sigma_of(1.2, SpectralEnd::lost), 1);
  EXPECT_LT(sigma_of(1.2, SpectralEnd::lost), sigma_of(1.5, SpectralEnd::lost));
  EXPECT_LT(sigma_of(100, SpectralEnd::lost), 3);
  EXPECT_EQ(sigma_of(1.2, SpectralEnd::nothing_changes), 0.3);
  EXPECT_EQ(doubted({.sigma = 2, .misfit = 0.8}).sigma, 2);
  EXPECT_GT(doubted({.sigma = 2, .misfit = 1.2}).sigma, 3);
}

/// A search with a budget of so many frames.
Focus of_frames(int frames, const DefocusedObject& object, double start, std::mt19937& random) {
  int taken = 0;
  const Objective objective{[&](double p) {
                              ++taken;
                              return Sample(1, object.at(p, random).picture);
                            },
                            [](double p) { return std::round(p); }};
  FocusLimits limits = limits_from(start);
  limits.most_pictures = frames;
  const Focus focus = search_focus(objective, limits, MetricSpec::parse("fft:64"), 0);
  EXPECT_LE(taken, frames);
  return focus;
}

TEST(SpectralBudget, TakesNoMorePicturesThanItMay) {
  std::mt19937 random(31);
  for (const int frames : {3, 5}) {
    int told = 0;
    for (unsigned i = 0; i < 20; ++i) {
      const DefocusedObject object{.focus = 600, .seed = i};
      const Focus focus = of_frames(frames, object, 600 + uniform(random, -150, 150), random);
      if (focus.result() != FocusResult::focused) continue;
      ++told;
      EXPECT_NEAR(focus.position(), 600, 4 * focus.peak.sigma) << frames << " frames, " << i;
    }
    EXPECT_GE(told, 18) << frames;
  }
}

/// Two pictures as far before the focus as behind it are alike, as if the lens changed nothing.
TEST(SpectralBudget, TellsAFocusBetweenTheFirstTwoPictures) {
  std::mt19937 random(32);
  int told = 0;
  constexpr int kCases = 40;
  for (unsigned i = 0; i < kCases; ++i) {
    const double half_a_hop = 1.5 / 0.08, away = half_a_hop + uniform(random, -4, 4);
    const DefocusedObject object{.focus = 600, .seed = i};
    const Focus focus = of_frames(3, object, 600 - away, random);
    if (focus.result() != FocusResult::focused) continue;
    ++told;
    EXPECT_NEAR(focus.position(), 600, 4 * focus.peak.sigma) << i;
  }
  EXPECT_GE(told, kCases * 3 / 4);
}

/// What the blur model does not know of pictures on either side shifts the focus this way and that.
TEST(SpectralBudget, ABlurThatIsAlmostRightShiftsTheFocusLittle) {
  std::mt19937 random(33);
  int close = 0;
  constexpr int kCases = 40;
  for (unsigned i = 0; i < kCases; ++i) {
    const double factor = i % 2 == 0 ? 1.03 : 0.97;
    const double away = uniform(random, 100, 190) * (i % 4 < 2 ? 1 : -1);
    const DefocusedObject object{.focus = 600, .px_per_unit = factor * 0.08, .seed = i};
    const Focus focus = of_frames(3, object, 600 + away, random);
    constexpr double kClose = 3;  // half a percent of the distance on the thesis' rig
    if (focus.result() == FocusResult::focused && std::abs(focus.position() - 600) < kClose)
      ++close;
  }
  EXPECT_GE(close, kCases * 9 / 10);
}

/// So few pictures fit a focus that is not there where the blur is of another lens.
TEST(SpectralBudget, BelievesNothingWhereTheLensBlursOtherwiseThanWasSaid) {
  std::mt19937 random(35);
  int noticed = 0;
  for (unsigned i = 0; i < 80; ++i) {
    const double factor = i % 2 == 0 ? 0.65 : 0.75;
    const DefocusedObject object{.focus = 600, .px_per_unit = factor * 0.08, .seed = i};
    const Focus focus = of_frames(3, object, 600 + uniform(random, -190, 190), random);
    noticed += focus.spectral_end == SpectralEnd::does_not_defocus;
    EXPECT_NE(focus.result(), FocusResult::focused) << i << " at " << focus.position();
  }
  EXPECT_GE(noticed, 4);
}

/// Far from the focus light from outside shows another false one to each window.
TEST(SpectralFit, NothingIsSureWhereTwoWindowsSayDifferentThings) {
  std::mt19937 random(34);
  for (unsigned i = 0; i < 10; ++i) {
    const DefocusedObject in_narrow{.focus = 600, .seed = i}, in_wide{.focus = 500, .seed = i};
    std::vector<Evaluation> both, one;
    for (const double position : {660.0, 720.0, 760.0}) {
      one.push_back(in_narrow.at(position, random));
      both.push_back(one.back());
      both.back().picture.rings[1] = in_wide.at(position, random).picture.rings[1];
    }
    const FocusLimits limits = limits_from(700);
    EXPECT_TRUE(is_sure(fit_all(one, 700, limits))) << i;
    EXPECT_FALSE(is_sure(fit_all(both, 700, limits))) << i;
  }
}

}  // namespace
}  // namespace fathom
