// SPDX-License-Identifier: Apache-2.0
// The comparison of metrics on stacks whose answers are known.
#include "tools/fathom/metric_comparison.hpp"

#include <cmath>

#include "tests/support/expect_error.hpp"
#include "tools/fathom/gradient_metrics.hpp"

namespace fathom {
namespace {

constexpr int kSide = 16;
constexpr double kNoise = 2;

/// Flat pictures at positions 0, 1, 2, ..
WindowStack grey_stack(std::size_t pictures) {
  WindowStack stack(kSide, Depth::bits8);
  const Frame grey(kSide, kSide, std::vector<std::uint8_t>(kSide * kSide, 120));
  for (std::size_t i = 0; i < pictures; ++i) stack.add(static_cast<double>(i), grey, {0, 0, kSide});
  return stack;
}

/// Deviation of all pixels of a stack whose pictures were grey.
double noise_in(const WindowStack& stack) {
  const Frame frame = stack.frame();
  double squares = 0;
  for (int y = 0; y < frame.height_px(); ++y) {
    for (int x = 0; x < frame.width_px(); ++x) {
      const double off = static_cast<double>(frame.at(x, y)) - 120;
      squares += off * off;
    }
  }
  return std::sqrt(squares / (double(frame.width_px()) * frame.height_px()));
}

double hill(double position, double peak, double half_width) {
  return 1 + 9 * std::exp(-std::log(2.0) * std::pow((position - peak) / half_width, 2));
}

/// Scores of a hill at `peak`, and at `astray` once the pixels are noisier than `most`.
FocusMethod method(const std::string& name, double peak, double most = 1e9, double astray = 0) {
  return method_by_scores(
      name,
      [=](const WindowStack& stack) {
        const double at = noise_in(stack) > most ? astray : peak;
        std::vector<double> scores;
        for (const double position : stack.positions()) scores.push_back(hill(position, at, 4));
        return scores;
      },
      1);
}

/// Scores by what they are at each position.
FocusMethod method_of(const std::string& name, double (*score)(double)) {
  return method_by_scores(
      name,
      [=](const WindowStack& stack) {
        std::vector<double> scores;
        for (const double position : stack.positions()) scores.push_back(score(position));
        return scores;
      },
      1);
}

MetricComparison compare(const std::vector<FocusMethod>& methods, std::size_t pictures = 40) {
  return compare_metrics(methods, grey_stack(pictures), kNoise, [](std::size_t, std::size_t) {});
}

TEST(CompareMetrics, RecommendsWhatStandsTheMostNoise) {
  // Noise of m times 2 grey levels makes a deviation of 2 m: 7 lies between 3 and 4 times, 13
  // between 6 and 8.
  const auto result = compare(
      {method("weak", 20.2, 7, 5), method("strong", 20, 13, 5), method("other", 19.8, 7, 5)});
  EXPECT_FALSE(result.doubt);
  ASSERT_TRUE(result.consensus && result.recommended);
  EXPECT_NEAR(*result.consensus, 20, 0.02);
  EXPECT_GE(result.tolerance, 1) << "the spacing of the pictures";
  EXPECT_EQ(result.methods[*result.recommended].name, "strong");
  EXPECT_EQ(result.advantage, Advantage::most_noise);
  EXPECT_EQ(result.methods[0].stands, 3);
  EXPECT_EQ(result.methods[1].stands, 6);
  EXPECT_NEAR(result.methods[0].off, 0.2, 0.02);
  EXPECT_NEAR(2 * result.methods[0].answer.peak.half_width, 8, 0.5);
  EXPECT_NEAR(result.methods[0].answer.contrast, 10, 0.5);
  EXPECT_EQ(result.methods[0].answer.maxima, 1);
}

TEST(CompareMetrics, PrefersLessScatterAmongEqualNoise) {
  const auto result = compare({method("off", 20.5), method("near", 20), method("far", 19.4)});
  EXPECT_EQ(result.methods[*result.recommended].name, "near");
  EXPECT_EQ(result.advantage, Advantage::least_scatter);
  EXPECT_TRUE(result.methods[1].stands_all);
}

TEST(CompareMetrics, TheConsensusIsTheMedian) {
  const auto result = compare({method("a", 20), method("b", 20.4), method("lost", 33),
                               method("c", 20.1), method("d", 20.2)});
  EXPECT_NEAR(*result.consensus, 20.2, 0.02) << "the middle one of five";
  EXPECT_FALSE(result.methods[2].agrees);
  EXPECT_EQ(result.methods[2].stands, 0);
  const auto even = compare({method("a", 20), method("b", 20.4)});
  EXPECT_NEAR(*even.consensus, 20.2, 0.02) << "the mean of the middle two";
}

TEST(CompareMetrics, RecommendsNothingWithoutAPeak) {
  const auto flat = [](double) { return 1.0; };
  const auto result =
      compare({method_of("flat", flat), method_of("level", flat), method("one", 20)});
  EXPECT_EQ(result.doubt, NoConsensus::no_peak);
  EXPECT_FALSE(result.recommended || result.consensus);
}

TEST(CompareMetrics, RecommendsNothingAtAnEnd) {
  const auto rising = [](double position) { return hill(position, 45, 12); };
  const auto result = compare({method_of("a", rising), method_of("b", rising)});
  EXPECT_EQ(result.doubt, NoConsensus::at_end);
}

TEST(CompareMetrics, RecommendsNothingWherePeaksDisagree) {
  const auto result = compare({method("a", 6), method("b", 15), method("c", 24), method("d", 33)});
  EXPECT_EQ(result.doubt, NoConsensus::disagreement);
}

TEST(CompareMetrics, NoticesPicturesOutOfOrder) {
  // 7 and 40 have no common factor: every picture is there once.
  const auto shuffled = [](double position) {
    return hill(static_cast<double>(static_cast<int>(position) * 7 % 40), 20, 4);
  };
  const auto result = compare({method_of("a", shuffled), method_of("b", shuffled)});
  EXPECT_EQ(result.doubt, NoConsensus::out_of_order);
}

TEST(CompareMetrics, SeesASecondHill) {
  const auto two = [](double position) { return hill(position, 10, 3) + hill(position, 30, 3); };
  const auto result = compare({method_of("a", two), method_of("b", two)});
  EXPECT_TRUE(result.has_second_hill);
  EXPECT_EQ(result.methods[0].answer.maxima, 2);
  EXPECT_FALSE(compare({method("a", 20)}).has_second_hill);
}

TEST(CompareMetrics, TakesLightOutOfScores) {
  WindowStack dimming(kSide, Depth::bits8);
  const Frame grey(kSide, kSide, std::vector<std::uint8_t>(kSide * kSide, 120));
  for (int i = 0; i < 40; ++i) {
    dimming.add(i, grey, {0, 0, kSide});
    dimming.set_light(100 - i / 2.0);
  }
  const auto in_that_light = method_by_scores(
      "lit",
      [](const WindowStack& stack) {
        std::vector<double> scores;
        for (std::size_t i = 0; i < stack.size(); ++i)
          scores.push_back(hill(stack.positions()[i], 20, 4) * std::pow(stack.lights()[i], 2));
        return scores;
      },
      2);
  EXPECT_NEAR(in_that_light.find(dimming, kNoise).peak.position, 20, 0.01);
}

TEST(CompareMetrics, NeedsACurve) {
  for (const std::size_t few : {1u, 4u}) {
    test::expect_error(ErrorCode::bad_argument, [&] { compare({method("a", 1)}, few); },
                       {"5 lens positions"});
  }
}

TEST(NamedMethods, AreTheEnginesAndTheGradients) {
  for (const std::string& name : usual_methods())
    EXPECT_FALSE(named_method(name, 64, "cpu", {}).name.empty()) << name;
  EXPECT_EQ(named_method("dct:entropy", 32, "cpu", {}).name, "dct:32:entropy");
  const auto refuse = [](const char* name, const char* word) {
    test::expect_error(ErrorCode::bad_argument, [&] { named_method(name, 64, "cpu", {}); }, {word});
  };
  refuse("fft:32", "32 x 32");
  refuse("fft:rings=4", "4 numbers");
  refuse("brenner", "no transform");
}

TEST(Gradients, OfOnePixelAndOfAnEdge) {
  std::vector<std::uint8_t> pixels(64);
  pixels[3 * 8 + 4] = 10;
  const Frame spot(8, 8, pixels);
  // -40 there and 10 at its four neighbours: the mean is 0.
  EXPECT_DOUBLE_EQ(laplacian_variance(spot, {0, 0, 8}), (1600.0 + 4 * 100) / 64);
  std::vector<std::uint16_t> wide(16 * 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 9; x < 16; ++x) wide[y * 16 + x] = 1000;
  }
  const Frame edge(16, 8, wide);
  // A step of 1000 is a gradient of 4000 in the two columns beside it.
  EXPECT_DOUBLE_EQ(tenengrad(edge, {5, 0, 8}), 2 * 8 * 4000.0 * 4000.0 / 64);
  EXPECT_DOUBLE_EQ(tenengrad(edge, {0, 0, 8}), 0) << "the edge is outside of the window";
}

TEST(WindowStack, AddsNoiseOfTheDeviationAndSeed) {
  const WindowStack stack = grey_stack(20);
  const WindowStack noisy = stack.with_noise(5, 3);
  EXPECT_NEAR(noise_in(noisy), 5, 0.2);
  EXPECT_DOUBLE_EQ(noise_in(stack.with_noise(5, 3)), noise_in(noisy));
  EXPECT_NE(noise_in(stack.with_noise(5, 4)), noise_in(noisy));
  EXPECT_NEAR(repeat_noise(stack.repeated(0, 20).with_noise(5, 1)), 5, 0.2);
  EXPECT_EQ(repeat_noise(stack.repeated(0, 1)), 0);
}

}  // namespace
}  // namespace fathom
