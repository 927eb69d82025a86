// SPDX-License-Identifier: Apache-2.0
#include "focus/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "backends/backends.hpp"
#include "engine/selection.hpp"
#include "focus/focus.hpp"

namespace fathom {
namespace {

const MetricSpec kFft = MetricSpec::standard(Transform::fft, 64);

Verdict verdict_of(std::span<const Evaluation> curve, const MetricSpec& spec, double scatter) {
  std::size_t next = 0;
  SearchTrace trace({[&](double) { return curve[next++].score; }, [](double p) { return p; }});
  for (const Evaluation& e : curve) trace.score_at(e.position);
  FocusLimits limits;
  limits.is_live = scatter > 0;  // of a recording nothing repeats
  return judge_search(trace, limits, {spec, scatter}).verdict;
}

/// Scores of featureless noisy windows, by the oracle itself.
std::vector<double> noise_scores(const MetricSpec& spec, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> grey(2000,
                                        60);  // wide against the grey levels, far from the limits
  const Selection selection = select_device(all_backends(), "reference", spec, 1);
  const auto plan = selection.device->plan(spec, 1);
  std::vector<double> scores;
  for (int i = 0; i < count; ++i) {
    std::vector<std::uint16_t> pixels(static_cast<std::size_t>(spec.n) * spec.n);
    for (auto& p : pixels) p = static_cast<std::uint16_t>(std::lround(grey(random)));
    scores.push_back(plan->score(Frame(spec.n, spec.n, std::move(pixels)), {0, 0, spec.n}));
  }
  return scores;
}

double relative_scatter(const std::vector<double>& values) {
  double mean = 0, squares = 0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1)) / mean;
}

TEST(JudgeSearch, TellsTheFocusOfACurveThatItOnlyRemembers) {
  std::vector<Evaluation> curve;
  for (int i = 0; i < 9; ++i)
    curve.push_back({i + 1, 10.0 * i, 1 + std::exp(-std::pow((10.0 * i - 42) / 15, 2))});
  SearchTrace remembered({});
  remembered.remember(curve);
  const Focus focus = judge_search(remembered, {}, {kFft, 0.01});
  EXPECT_TRUE(focus.evaluations.empty());
  EXPECT_NEAR(focus.peak.position, 42, 1);
}

TEST(WhiteNoiseScatter, IsWhatTheOracleMeasures) {
  for (const char* text :
       {"fft:16:hann", "fft:16:none", "fft:16:none:power", "fft:32:none:band=0-0.25",
        "walsh-sequency:16", "walsh-paley:16:power", "walsh-sequency:32:band=0-0.25",
        "fft:32:tukey=0.5", "dct:16", "dct:16:entropy", "dct:32:entropy:band=0-0.25"}) {
    const MetricSpec spec = MetricSpec::parse(text);
    const double measured = relative_scatter(noise_scores(spec, 600, 11));
    // 600 samples tell a standard deviation to 3 %; neighbouring bins under a taper share a little
    // more than the formula's second-order correlation says.
    EXPECT_NEAR(white_noise_scatter(spec) / measured, 1, 0.2) << text;
  }
}

// A normalised spectrum does not grow with the light, and its noise is not of one strength.
TEST(WhiteNoiseScatter, OfAnEntropyFollowsNoLight) {
  const MetricSpec spec = MetricSpec::parse("dct:64:entropy");
  EXPECT_EQ(light_exponent(spec), 0);
  EXPECT_EQ(light_exponent(MetricSpec::parse("dct:64:power")), 2);
  EXPECT_EQ(white_noise_score(spec), 0);
}

TEST(Judge, NeverTakesNoiseForAFocus) {
  const auto scores = noise_scores(MetricSpec::parse("fft:16:hann"), 4000, 5);
  const MetricSpec spec = MetricSpec::parse("fft:16:hann");
  int judged = 0;
  for (const std::size_t length : {5u, 10u, 25u, 60u}) {
    for (std::size_t start = 0; start + length <= scores.size(); start += length) {
      std::vector<Evaluation> curve;
      for (std::size_t i = 0; i < length; ++i) {
        curve.push_back({static_cast<int>(i) + 1, static_cast<double>(i), scores[start + i]});
      }
      EXPECT_EQ(verdict_of(curve, spec, 0).result, FocusResult::no_focus);
      ++judged;
    }
  }
  EXPECT_GT(judged, 1000);
}

std::vector<Evaluation> lorentzian(double peak, double floor, double width) {
  std::vector<Evaluation> curve;
  for (int p = 0; p <= 1200; p += 50) {
    const double x = (p - peak) / width;
    curve.push_back({static_cast<int>(curve.size()) + 1, static_cast<double>(p),
                     floor + (1 - floor) / (1 + x * x)});
  }
  return curve;
}

TEST(Judge, SeesAPeak) {
  const Verdict verdict = verdict_of(lorentzian(700, 0.2, 30), kFft, 0.01);
  EXPECT_EQ(verdict.result, FocusResult::focused);
  EXPECT_NEAR(verdict.rise.contrast, 0.8, 0.02);
  EXPECT_GT(verdict.rise.rise, verdict.rise.needed);
}

TEST(Judge, DoesNotTrustAnEnd) {
  EXPECT_EQ(verdict_of(lorentzian(0, 0.2, 30), kFft, 0.01).result, FocusResult::at_limit);
  EXPECT_EQ(verdict_of(lorentzian(1200, 0.2, 30), kFft, 0.01).result, FocusResult::at_limit);
  EXPECT_EQ(verdict_of(lorentzian(1500, 0.2, 300), kFft, 0.01).result, FocusResult::at_limit);
}

TEST(Judge, AsksMoreOfALightThatFlickers) {
  EXPECT_EQ(verdict_of(lorentzian(700, 0.6, 30), kFft, 0.01).result, FocusResult::focused);
  EXPECT_EQ(verdict_of(lorentzian(700, 0.6, 30), kFft, 0.2).result, FocusResult::no_focus);
}

TEST(Judge, ABlackOrFlatCurveHasNoFocus) {
  std::vector<Evaluation> flat;
  for (int i = 0; i < 20; ++i) flat.push_back({i + 1, static_cast<double>(i), 0});
  EXPECT_EQ(verdict_of(flat, kFft, 0).result, FocusResult::no_focus);
  for (Evaluation& e : flat) e.score = 0.5;
  EXPECT_EQ(verdict_of(flat, kFft, 0).result, FocusResult::no_focus);
  EXPECT_EQ(verdict_of(std::vector<Evaluation>{{1, 0, 3}}, kFft, 0).result, FocusResult::no_focus);
}

TEST(Judge, OneLitPictureAmongBlackOnesIsNoFocus) {
  const std::vector<Evaluation> curve = {{1, 0, 0}, {2, 1, 0.4}, {3, 2, 0}, {4, 3, 0}};
  const Verdict verdict = verdict_of(curve, kFft, 0);
  EXPECT_EQ(verdict.result, FocusResult::no_focus);
  EXPECT_EQ(verdict.reason.why, Why::dead_pictures);
  EXPECT_EQ(verdict.reason.dead, 3);
  EXPECT_EQ(verdict.reason.evaluations, 4);
}

// Blank cards, and both ends black or wholly saturated: the dead pictures are no floor.
TEST(Judge, NoiseBetweenBlackEndsIsNoFocus) {
  const auto scores = noise_scores(MetricSpec::parse("fft:16:hann"), 400, 6);
  for (std::size_t start = 0; start + 10 <= scores.size(); start += 10) {
    std::vector<Evaluation> curve = {{1, 0, 0}, {2, 1, 1e-14 * scores[0]}};
    for (std::size_t i = 0; i < 10; ++i)
      curve.push_back({static_cast<int>(i) + 3, 2.0 + static_cast<double>(i), scores[start + i]});
    curve.push_back({13, 12, 0});
    EXPECT_EQ(verdict_of(curve, MetricSpec::parse("fft:16:hann"), 0).result, FocusResult::no_focus);
  }
}

TEST(Confidence, DoesNotDependOnTheLight) {
  auto curve = lorentzian(700, 0.2, 30);
  const double one = verdict_of(curve, kFft, 0.01).confidence;
  EXPECT_GT(one, 0.8);
  for (const double light : {1e-9, 0.5, 1e9}) {
    auto other = curve;
    for (Evaluation& e : other) e.score *= light;
    EXPECT_NEAR(verdict_of(other, kFft, 0.01).confidence, one, 1e-9) << light;
  }
}

TEST(Confidence, HardlyDependsOnThePartOfTheWindowThatTheObjectFills) {
  const double one = verdict_of(lorentzian(700, 0.1, 60), kFft, 0.002).confidence;
  for (const double part : {0.5, 0.25}) {
    auto curve = lorentzian(700, 0.1, 60);
    for (Evaluation& e : curve) e.score = 0.1 + part * (e.score - 0.1);
    EXPECT_NEAR(verdict_of(curve, kFft, 0.002).confidence, one, 0.1) << part;
  }
}

TEST(Confidence, FallsWithNoiseAndWithASecondPeak) {
  const auto curve = lorentzian(700, 0.2, 60);
  double last = 1;
  for (const double scatter : {0.002, 0.02, 0.08}) {
    const double confidence = verdict_of(curve, kFft, scatter).confidence;
    EXPECT_LT(confidence, last) << scatter;
    last = confidence;
  }
  const double alone = verdict_of(curve, kFft, 0.002).confidence;
  for (const double second : {0.35, 0.6, 0.95}) {
    auto two = curve;
    for (Evaluation& e : two) e.score += 0.8 * second / (1 + std::pow((e.position - 250) / 60, 2));
    const Verdict verdict = verdict_of(two, kFft, 0.002);
    EXPECT_EQ(verdict.result,
              second < kAmbiguousHeight ? FocusResult::focused : FocusResult::ambiguous);
    EXPECT_NEAR(verdict.confidence / alone, 1 - second, 0.1) << second;
  }
}

TEST(Confidence, IsNoneWithoutAFocus) {
  EXPECT_EQ(verdict_of(lorentzian(0, 0.2, 30), kFft, 0.01).confidence, 0);
  EXPECT_EQ(verdict_of(lorentzian(700, 0.97, 30), kFft, 0.01).confidence, 0);
}

TEST(Judge, SaysOfOnePositionThatItIsOne) {
  const Verdict verdict = verdict_of(std::vector<Evaluation>{{1, 0, 3}}, kFft, 0);
  EXPECT_EQ(verdict.reason.why, Why::one_position);
}

Why why_of(const std::vector<Evaluation>& curve, double scatter) {
  return verdict_of(curve, kFft, scatter).reason.why;
}

TEST(Judge, SaysWhy) {
  EXPECT_EQ(why_of(lorentzian(700, 0.2, 30), 0), Why::stands_out);
  EXPECT_EQ(why_of(lorentzian(700, 0.99, 30), 0), Why::within_noise);
  auto flat = lorentzian(700, 0.2, 30);
  for (Evaluation& e : flat) e.score = 0.5;
  EXPECT_EQ(why_of(flat, 0), Why::all_alike);
  EXPECT_EQ(why_of(lorentzian(700, 0.2, 30), 0.6), Why::too_wild);
}

TEST(Judge, SaysWhereTheEndIs) {
  const Reason reason = verdict_of(lorentzian(0, 0.2, 30), kFft, 0).reason;
  EXPECT_EQ(reason.why, Why::at_end);
  EXPECT_EQ(reason.position, 0);
}

TEST(Judge, SaysWhereBothPeaksAre) {
  auto two = lorentzian(700, 0.2, 60);
  for (Evaluation& e : two) e.score += 0.8 * 0.6 / (1 + std::pow((e.position - 250) / 60, 2));
  const Reason reason = verdict_of(two, kFft, 0.002).reason;
  EXPECT_EQ(reason.why, Why::two_peaks);
  EXPECT_NEAR(reason.position, 700, 5);
  EXPECT_NEAR(reason.second_position, 250, 5);
  EXPECT_NEAR(reason.second_part, 0.6, 0.05);
}

TEST(Judge, SaysHowSureAPeakIsThatIsNotSureEnough) {
  // Just above what is needed: a peak, but hardly.
  for (double scatter = 0.02; scatter < 0.2; scatter += 0.002) {
    const Verdict verdict = verdict_of(lorentzian(700, 0.6, 60), kFft, scatter);
    if (verdict.reason.why != Why::unsure) continue;
    EXPECT_EQ(verdict.result, FocusResult::no_focus);
    EXPECT_EQ(verdict.confidence, 0);
    EXPECT_GT(verdict.reason.confidence, 0);
    EXPECT_LT(verdict.reason.confidence, kLeastConfidence);
    return;
  }
  FAIL() << "no scatter made the peak unsure";
}

TEST(Why, EachHasANameOfItsOwn) {
  std::set<std::string> names;
  for (const Why why : kWhys) names.insert(to_string(why));
  EXPECT_EQ(names.size(), std::size(kWhys));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(Why::two_peaks) + 1);
}

}  // namespace
}  // namespace fathom
