// SPDX-License-Identifier: Apache-2.0
// The default search, and what every search must keep to whatever the curve.
#include "focus/auto_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "engine/error.hpp"
#include "focus/focus.hpp"
#include "focus/searches.hpp"

namespace fathom {
namespace {

using Function = std::function<double(double)>;

const MetricSpec kFft = MetricSpec::standard(Transform::fft, 64);
const LensInfo kLens{"test lens", "steps", 0, 1200, 1, 100, {}};
constexpr double kScatter = 0.005;

LensInfo lens_that_knows_nothing() {
  LensInfo lens = kLens;
  lens.coarse_spacing = 0;
  return lens;
}

double hill(double position, double peak, double width) {
  const double z = (position - peak) / width;
  return 1 / (1 + z * z);
}

Focus search(const Function& score, const FocusRequest& request = {},
             const LensInfo& lens = kLens) {
  const Objective objective{score, [lens](double p) { return nearest_position(lens, p); }};
  return search_focus(objective, resolve_limits(request, lens), kFft, kScatter);
}

std::vector<SearchMethod> all_methods() {
  std::vector<SearchMethod> methods;
  for (const Search& search : searches()) methods.push_back(search.method);
  return methods;
}

FocusRequest by(SearchMethod method) {
  FocusRequest request;
  // Scores alone come without spectra: it must go on without.
  if (method == SearchMethod::spectral) request.blur = BlurModel{.px_per_unit = 0.08};
  request.search = method;
  return request;
}

TEST(AutoSearch, HalvesItsWayToAPeakOfALensThatKnowsNoDepthOfFocus) {
  const LensInfo lens = lens_that_knows_nothing();
  const FocusLimits limits = resolve_limits({}, lens);
  EXPECT_TRUE(limits.coarse.is_guess);
  EXPECT_GE(limits.coarse.halvings, 3);
  EXPECT_EQ(limits.coarse.positions.front(), 0);
  EXPECT_EQ(limits.coarse.positions.back(), 1200);
  for (const double width : {12.0, 30.0, 150.0}) {
    for (double peak = 61; peak < 1150; peak += 83) {
      const Focus focus = search([&](double p) { return 0.16 + hill(p, peak, width); }, {}, lens);
      EXPECT_EQ(focus.result(), FocusResult::focused) << peak << " " << width;
      EXPECT_NEAR(focus.position(), peak, 0.1 * width) << peak << " " << width;
    }
  }
}

TEST(AutoSearch, GuessesNoFinerThanTheLensMoves) {
  LensInfo lens = lens_that_knows_nothing();
  lens.highest = 3;
  EXPECT_EQ(resolve_limits({}, lens).coarse.positions.size(), 4u);
  EXPECT_GE(resolve_limits(by(SearchMethod::hill), lens).first_step, lens.resolution);
}

/// A high, broad hill that begins far from the small one at 200.
double with_a_local_maximum(double p) { return 0.1 + 0.4 * hill(p, 200, 40) + hill(p, 850, 40); }

TEST(Searches, AHillClimbEndsOnTheHillThatItBeganOn) {
  FocusRequest request = by(SearchMethod::hill);
  request.start = 150;
  EXPECT_NEAR(search(with_a_local_maximum, request).position(), 200, 5);
  for (const SearchMethod method : {SearchMethod::automatic, SearchMethod::full})
    EXPECT_NEAR(search(with_a_local_maximum, by(method)).position(), 850, 1) << to_string(method);
}

TEST(Searches, AHillClimbMovesOnAStackOfFrames) {
  const LensInfo stack{"stack", "frames", 0, 8, 1, 1, {0, 1, 2, 3, 4, 5, 6, 7, 8}};
  const Focus focus =
      search([](double p) { return 0.1 + hill(p, 5, 1.5); }, by(SearchMethod::hill), stack);
  EXPECT_NEAR(focus.position(), 5, 0.1);
  EXPECT_EQ(focus.result(), FocusResult::focused);
}

// Of the points that it has seen an auto search needs none near the top.
TEST(Searches, AnEvaluatedAnswerIsAsUnsureAsItsNeighboursAreFar) {
  for (const SearchMethod method : all_methods()) {
    double squares = 0;
    int count = 0;
    for (double peak = 300.3; peak < 900; peak += 11.7, ++count) {
      FocusRequest request = by(method);
      request.peak = PeakMethod::evaluated;
      request.start = peak - 60;
      const Focus focus = search([&](double p) { return 0.16 + hill(p, peak, 25); }, request);
      EXPECT_EQ(focus.position(), best_of(focus.evaluations).position);
      squares += std::pow((focus.position() - peak) / focus.peak.sigma, 2);
    }
    EXPECT_LT(std::sqrt(squares / count), 1.6) << to_string(method);
  }
}

// Few points far down the slopes: the answer may be off, and its sigma must say so. Not by as much
// as it should, 1: a Gaussian through four points of a Lorentzian is off by 2.7 of its sigmas.
TEST(Searches, SigmaIsHonestAlsoForAWideTolerance) {
  for (const SearchMethod method :
       {SearchMethod::golden, SearchMethod::fibonacci, SearchMethod::brent}) {
    double squares = 0;
    int count = 0;
    for (double peak = 250; peak < 950; peak += 5.3, ++count) {
      FocusRequest request = by(method);
      request.tolerance = 1e6;
      const Focus focus = search([&](double p) { return 0.16 + hill(p, peak, 25); }, request);
      squares += std::pow((focus.position() - peak) / focus.peak.sigma, 2);
    }
    EXPECT_LT(std::sqrt(squares / count), 3) << to_string(method);
  }
}

void expect_same(const Focus& a, const Focus& b, const std::string& what) {
  ASSERT_EQ(a.evaluations.size(), b.evaluations.size()) << what;
  for (std::size_t i = 0; i < a.evaluations.size(); ++i)
    EXPECT_EQ(a.evaluations[i].position, b.evaluations[i].position) << what << " at " << i;
  EXPECT_EQ(a.result(), b.result()) << what;
  EXPECT_NEAR(a.position(), b.position(), 1e-6) << what;
  EXPECT_NEAR(a.peak.sigma, b.peak.sigma, 1e-6 * b.peak.sigma) << what;
  EXPECT_NEAR(a.verdict.confidence, b.verdict.confidence, 1e-6) << what;
}

TEST(Searches, DoNotDependOnTheUnitOfTheScore) {
  for (const SearchMethod method : all_methods()) {
    for (const double peak : {333.3, 777.7}) {
      FocusRequest request = by(method);
      request.start = 400;
      const Function score = [&](double p) { return 0.1 + hill(p, peak, 30); };
      const Focus one = search(score, request);
      for (const double scale : {1e-9, 1e9}) {
        expect_same(search([&](double p) { return scale * score(p); }, request), one,
                    std::string(to_string(method)) + " times " + std::to_string(scale));
      }
    }
  }
}

TEST(Searches, DoNotDependOnWhereTheTravelBegins) {
  for (const SearchMethod method : all_methods()) {
    LensInfo shifted = kLens;
    shifted.lowest += 4096;
    shifted.highest += 4096;
    FocusRequest here = by(method), there = by(method);
    here.start = 400;
    there.start = 400 + 4096;
    const Focus one = search([](double p) { return 0.1 + hill(p, 501.4, 30); }, here);
    const Focus other =
        search([](double p) { return 0.1 + hill(p - 4096, 501.4, 30); }, there, shifted);
    EXPECT_EQ(other.evaluations.size(), one.evaluations.size()) << to_string(method);
    EXPECT_NEAR(other.position() - 4096, one.position(), 1e-6) << to_string(method);
  }
}

TEST(Searches, SeeAMirroredCurveMirrored) {
  for (const SearchMethod method : {SearchMethod::automatic, SearchMethod::full}) {
    for (double peak = 90; peak < 1110; peak += 71.3) {
      const Focus one = search([&](double p) { return 0.1 + hill(p, peak, 30); }, by(method));
      const Focus other =
          search([&](double p) { return 0.1 + hill(1200 - p, peak, 30); }, by(method));
      EXPECT_EQ(one.result(), other.result()) << to_string(method) << peak;
      EXPECT_NEAR(1200 - other.position(), one.position(), 0.05) << to_string(method) << peak;
      EXPECT_LE(other.evaluations.size(), one.evaluations.size() + 4) << peak;
      EXPECT_LE(one.evaluations.size(), other.evaluations.size() + 4) << peak;
    }
  }
}

TEST(Searches, RefuseScoresThatAreNoNumbers) {
  for (const SearchMethod method : all_methods()) {
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      const Function score = [&](double p) { return p > 100 ? bad : 1; };
      FocusRequest request = by(method);
      request.start = 90;
      EXPECT_THROW(search(score, request), Error) << to_string(method);
    }
  }
}

/// A curve of any kind: hills, slopes, steps, noise, silence.
Function random_curve(std::mt19937& random) {
  const auto pick = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  const int hills = static_cast<int>(random() % 4);
  const double floor = random() % 4 == 0 ? 0 : pick(0, 1), noise = pick(0, 1) * pick(0, 0.3);
  const double slope = pick(-1e-3, 1e-3) * static_cast<double>(random() % 2);
  const double scale = std::pow(10, pick(-12, 12));
  const auto seed = static_cast<std::uint32_t>(random());
  std::vector<std::array<double, 3>> shapes;
  for (int i = 0; i < hills; ++i)
    shapes.push_back({pick(-100, 1300), std::pow(10, pick(-1, 2.5)), pick(0, 2)});
  return [=](double p) {
    double score = floor + std::abs(slope * p);
    for (const auto& [at, width, height] : shapes) score += height * hill(p, at, width);
    std::minstd_rand dice(seed ^ static_cast<std::uint32_t>(std::lround(16 * p) + 99));
    dice.discard(3);
    score += noise * (static_cast<double>(dice()) / 2147483647.0 - 0.5);
    return scale * std::max(score, 0.0);
  };
}

LensInfo random_lens(std::mt19937& random) {
  LensInfo lens = kLens;
  const double resolutions[] = {0.25, 1, 7}, spacings[] = {0, 1, 50, 100, 5000};
  lens.resolution = resolutions[random() % 3];
  lens.coarse_spacing = spacings[random() % 5];
  if (random() % 4 == 0) {
    std::set<double> stops;
    for (int i = 0; i < 1 + static_cast<int>(random() % 30); ++i)
      stops.insert(static_cast<double>(random() % 1201));
    lens.stops.assign(stops.begin(), stops.end());
    lens.lowest = lens.stops.front();
    lens.highest = lens.stops.back();
  }
  return lens;
}

void expect_sound(const Focus& focus, const FocusLimits& limits, const LensInfo& lens) {
  std::set<double> seen;
  ASSERT_FALSE(focus.evaluations.empty());
  for (const Evaluation& e : focus.evaluations) {
    EXPECT_TRUE(seen.insert(e.position).second) << "twice at " << e.position;
    EXPECT_EQ(e.position, nearest_position(lens, e.position)) << "no position of the lens";
  }
  const double low = nearest_position(lens, limits.from), high = nearest_position(lens, limits.to);
  EXPECT_GE(*seen.begin(), low);
  EXPECT_LE(*seen.rbegin(), high);
  EXPECT_GE(focus.position(), low);
  EXPECT_LE(focus.position(), high);
  EXPECT_TRUE(std::isfinite(focus.peak.sigma) && focus.peak.sigma > 0) << focus.peak.sigma;
  EXPECT_GE(focus.verdict.confidence, 0);
  EXPECT_LE(focus.verdict.confidence, 1);
  EXPECT_TRUE(std::isfinite(focus.peak.score));
  EXPECT_NE(focus.verdict.reason.why, Why::unknown);
  EXPECT_FALSE(focus.lobes.empty());
}

TEST(Searches, AreSoundWhateverTheCurve) {
  std::mt19937 random(1989);
  for (int run = 0; run < 500; ++run) {
    const Function score = random_curve(random);
    const LensInfo lens = random_lens(random);
    FocusRequest request = by(searches()[random() % searches().size()].method);
    if (random() % 2 == 0) {
      const double a = nearest_position(lens, static_cast<double>(random() % 1201));
      const double b = nearest_position(lens, static_cast<double>(random() % 1201));
      request.from = std::min(a, b);
      request.to = std::max(a, b);
    }
    const double tolerances[] = {0.5, 2, 40};
    request.tolerance = tolerances[random() % 3];
    request.start = static_cast<double>(random() % 1201);
    request.peak = random() % 4 == 0 ? PeakMethod::evaluated : PeakMethod::fit;
    const double scatters[] = {0, 0.005, 0.2};
    const double scatter = scatters[random() % 3];
    const FocusLimits limits = resolve_limits(request, lens);
    const Objective objective{score, [&](double p) { return nearest_position(lens, p); }};
    const Focus focus = search_focus(objective, limits, kFft, scatter);
    expect_sound(focus, limits, lens);
    const Focus again = search_focus(objective, limits, kFft, scatter);
    EXPECT_EQ(focus.evaluations, again.evaluations);
    EXPECT_EQ(focus.peak.position, again.peak.position);
    if (HasFailure()) FAIL() << "run " << run << ", " << to_string(limits.search);
  }
}

// A camera with its cap on, between whose positions a lens has others.
TEST(Searches, AskForNumbersInTheDark) {
  for (const LensInfo& lens : {kLens, lens_that_knows_nothing()}) {
    for (const SearchMethod method : all_methods()) {
      for (const double faint : {0.0, 1e-300, 1e-9}) {
        const Function score = [&](double p) {
          EXPECT_TRUE(std::isfinite(p)) << to_string(method);
          return std::fmod(std::abs(p), 3) < 1 ? faint : 0;
        };
        const Objective objective{score, [lens](double p) { return nearest_position(lens, p); }};
        for (const double scatter : {0.0, kScatter})
          search_focus(objective, resolve_limits(by(method), lens), kFft, scatter);
      }
    }
  }
}

}  // namespace
}  // namespace fathom
