// SPDX-License-Identifier: Apache-2.0
// The numbers: scores against the golden values and against the oracle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "tests/conformance/suite.hpp"
#include "tests/golden/golden_file.hpp"
#include "tests/support/canary.hpp"
#include "tests/support/oracle_compare.hpp"

namespace fathom::conformance {
namespace {

using test::bit_equal;
using test::score_matches;

class Scores : public Conformance {
 protected:
  static double score(Plan& plan, const Frame& frame) {
    return plan.score(frame, {0, 0, plan.spec().n});
  }

  static double least_scale(const Case& tested) {
    return test::least_scale(tested.spec, [&](const MetricSpec& spec) {
      Case whole = tested;
      whole.spec = spec;
      return oracle_score(whole);
    });
  }
};
FATHOM_EVERY_DEVICE(Scores);

TEST_P(Scores, MatchTheGoldenValues) {
  std::vector<Case> all;
  std::map<std::string, double> expected;
  for (const test::Golden& golden : test::read_golden(golden_file())) {
    const MetricSpec spec = MetricSpec::parse(golden.spec);
    if (spec.measure == Measure::rings) continue;  // rings.cpp
    all.push_back({spec, golden.content, golden.bits, golden.seed});
    expected[all.back().text()] = golden.values[0];
  }
  std::size_t not_zero = 0;
  each(all, 1, [&](const Case& tested, Plan& plan) {
    const double golden = expected.at(tested.text());
    not_zero += golden > 0;
    EXPECT_TRUE(
        score_matches(score(plan, tested.frame()), golden, tested.spec, tolerance(tested.spec)));
  });
  EXPECT_TRUE(not_zero > 0 || IsSkipped() || is_filtered()) << "only zeros were compared";
}

std::vector<std::string> reference_specs(int n) {
  const std::string size = ":" + std::to_string(n);
  std::vector<std::string> specs = {"fft" + size + ":hann",
                                    "walsh-paley" + size,
                                    "walsh-sequency" + size,
                                    "walsh-hadamard" + size,
                                    "walsh-sequency" + size + ":band=0-0.25",
                                    "dct" + size + ":entropy",
                                    "dct" + size + ":entropy:band=0-0.25"};
  if (n > 128) return specs;
  if (n == 8 || n == 64) {  // all sizes have the same code
    for (const char* options : {"", ":power", ":band=0.05-0.3"})
      specs.push_back("dct" + size + options);
  }
  for (const char* taper : {":none", ":tukey=0.25", ":tukey=0.6"})
    specs.push_back("fft" + size + taper);
  for (const char* options : {":power", ":band=0-0.25", ":power:band=0.05-0.3"}) {
    specs.push_back("fft" + size + ":hann" + options);
    if (std::string(options) != ":power") specs.push_back("walsh-sequency" + size + options);
  }
  for (const char* order : {"walsh-paley", "walsh-sequency", "walsh-hadamard"}) {
    for (const char* options : {":power", ":hann", ":tukey=0.25", ":hann:power"}) {
      specs.push_back(order + size + options);
    }
  }
  return specs;
}

// Wider than the golden file, because the oracle is at hand: other seeds, every picture.
TEST_P(Scores, MatchTheReference) {
  if (GetParam().is_reference()) GTEST_SKIP() << "the oracle itself; the golden values hold it";
  std::vector<Case> all;
  for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
    std::vector<std::string> pictures;
    for (const std::string& content : test::contents()) {
      if (n > 128 && content != "natural" && content != "nearly-flat" && content != "binary")
        continue;
      for (const char* bits : {"8", "16"}) pictures.push_back(content + bits);
    }
    if (n == kLargestWindow) pictures = {"nearly-flat8", "natural16"};
    for (Case& tested : cases(reference_specs(n), pictures, 1000 + n)) all.push_back(tested);
  }
  std::size_t not_zero = 0;
  each(all, 1, [&](const Case& tested, Plan& plan) {
    const double expected = oracle_score(tested);
    not_zero += expected > 0;
    EXPECT_TRUE(score_matches(score(plan, tested.frame()), expected, tested.spec,
                              tolerance(tested.spec), least_scale(tested)));
  });
  EXPECT_TRUE(not_zero > 0 || IsSkipped() || is_filtered()) << "only zeros were compared";
}

/// Pictures whose spectra leave nearly all coefficients empty, so that rounding has nothing to
/// drown in: what single precision gets wrong by a hundred tolerances if it is not careful.
std::vector<std::pair<std::string, test::Pixels>> sparse_pictures(int n) {
  std::vector<std::pair<std::string, test::Pixels>> pictures;
  const auto draw = [&](const std::string& name, auto&& grey) {
    test::Pixels picture{n, n, 8, std::vector<std::uint16_t>(static_cast<std::size_t>(n) * n)};
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        picture.at(x, y) = static_cast<std::uint16_t>(std::clamp<double>(grey(x, y), 0, 255));
      }
    }
    pictures.emplace_back(name, std::move(picture));
  };
  const int slope = std::max(1, 255 / n);
  draw("ramp down", [=](int, int y) { return slope * y; });
  draw("ramp across", [=](int x, int) { return slope * x; });
  draw("diagonal ramp", [=](int x, int y) { return slope * (x + y) / 2; });
  draw("pyramid",
       [=](int x, int y) { return 3 * std::max(std::abs(x - n / 2), std::abs(y - n / 2)); });
  draw("diagonal wave", [=](int x, int y) {
    return std::floor(127.5 + 127 * std::sin(4 * std::numbers::pi * (x + y) / n));
  });
  draw("wave across", [=](int x, int) {
    return std::floor(127.5 + 127 * std::sin(2 * std::numbers::pi * x / n));
  });
  draw("one grey level in a corner",
       [=](int x, int y) { return x == n - 1 && y == 3 ? 107 : 106; });
  draw("a column one grey level up", [=](int x, int) { return x == n / 3 ? 187 : 186; });
  draw("a bright pixel where the taper is small",
       [=](int x, int y) { return x == n - 1 && y == n - 3 ? 255 : 0; });
  const auto wave = [=](int k) {
    return std::round(127 + 126 * std::cos(2 * std::numbers::pi * (k + 0.3) / n));
  };
  draw("a wave in the first column", [=](int x, int y) { return x == 0 ? wave(y) : 0; });
  draw("a wave in the last row", [=](int x, int y) { return y == n - 1 ? wave(x) : 0; });
  draw("an edge in the second column", [=](int x, int y) { return x == 1 && y > n / 3 ? 200 : 0; });
  draw("a wide spot", [=](int x, int y) {
    const double dx = x - (n - 1) / 2.0, dy = y - (n - 1) / 2.0;
    return 250 * std::exp(-(dx * dx + dy * dy) * 8 / (n * n));
  });
  return pictures;
}

/// The oracle's score of one of sparse_pictures(), remembered for the next device.
double sparse_oracle_score(Plan& oracle, const std::string& name, const Frame& frame) {
  static std::map<std::string, double> known;
  const auto [entry, is_new] = known.try_emplace(oracle.spec().text() + "/" + name);
  if (is_new) entry->second = oracle.score(frame, {0, 0, oracle.spec().n});
  return entry->second;
}

TEST_P(Scores, HoldWhereMostCoefficientsAreEmpty) {
  if (GetParam().is_reference()) GTEST_SKIP() << "the oracle itself; the golden values hold it";
  std::vector<std::string> specs = {"fft:256:hann", "fft:256:none", "fft:256:tukey=0.6:power",
                                    "fft:512:hann", "dct:256:entropy"};
  for (const char* n : {"8", "16", "32", "64", "128"}) {
    for (const char* options : {":hann", ":none", ":tukey=0.25", ":tukey=0.6", ":hann:power",
                                ":none:power", ":hann:band=0.25-0.5"}) {
      specs.push_back(std::string("fft:") + n + options);
    }
    for (const char* options : {":entropy", ":entropy:band=0.1-0.3"})
      specs.push_back(std::string("dct:") + n + options);
  }
  each(cases(specs, {"sparse8"}), 1, [&](const Case& tested, Plan& plan) {
    for (const auto& picture : sparse_pictures(tested.spec.n)) {
      const std::string& name = picture.first;
      SCOPED_TRACE(name);
      const Frame frame = test::to_frame(picture.second);
      const double expected = sparse_oracle_score(*oracle(tested.spec), name, frame);
      const double least = test::least_scale(tested.spec, [&](const MetricSpec& whole) {
        return sparse_oracle_score(*oracle(whole), name, frame);
      });
      EXPECT_TRUE(
          score_matches(score(plan, frame), expected, tested.spec, tolerance(tested.spec), least));
    }
  });
}

TEST_P(Scores, AreExactlyZeroForABlackWindow) {
  std::vector<std::string> specs = typical_specs();
  for (const std::string& spec : large_specs()) specs.push_back(spec);
  each(cases(specs, {"zero8", "zero16"}), 1, [](const Case& tested, Plan& plan) {
    EXPECT_TRUE(bit_equal(score(plan, tested.frame()), 0));
  });
}

TEST_P(Scores, AreExactlyZeroForAFlatWindowWithoutATaper) {
  each(cases({"fft:16:none", "fft:64:none", "fft:128:none:power", "walsh-paley:64",
              "walsh-sequency:128", "walsh-hadamard:32:power", "dct:64", "dct:8:entropy",
              "dct:128:entropy"},
             {"flat8", "full8", "full16"}),
       1, [](const Case& tested, Plan& plan) {
         EXPECT_TRUE(bit_equal(score(plan, tested.frame()), 0));
       });
}

/// How many times the score a picture has whose light is so many times as strong.
double growth(const MetricSpec& spec, double light) {
  if (spec.measure == Measure::entropy) return 1;  // of a normalised spectrum
  return spec.power ? light * light : light;
}

// |F| of a sum of two pictures is what it is, but of a picture times two it is doubled.
TEST_P(Scores, GrowWithTheContrast) {
  each(cases(typical_specs(), {"natural8"}), 1, [&](const Case& tested, Plan& plan) {
    test::Pixels pixels = tested.pixels(tested.spec.n, tested.spec.n);
    const double once = score(plan, test::to_frame(pixels));
    pixels.bits = 16;
    for (auto& value : pixels.values) value = static_cast<std::uint16_t>(value * 128);
    const double factor = growth(tested.spec, 128);
    ASSERT_GT(once, 0);
    EXPECT_TRUE(score_matches(score(plan, test::to_frame(pixels)), factor * once, tested.spec,
                              2 * tolerance(tested.spec)));
  });
}

TEST_P(Scores, TellWhichPictureIsSharper) {
  each(cases(typical_specs(), {"random8", "random16"}), 1, [](const Case& tested, Plan& plan) {
    // The norm of an entropy holds what its band leaves out: of bare noise, blurring lowers that more.
    if (tested.spec.measure == Measure::entropy && tested.spec.band) return;
    const int n = tested.spec.n;
    const test::Pixels sharp = tested.pixels(n, n);
    test::Pixels blurred = sharp;
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        const int right = std::min(x + 1, n - 1), below = std::min(y + 1, n - 1);
        blurred.at(x, y) = static_cast<std::uint16_t>(
            (sharp.at(x, y) + sharp.at(right, y) + sharp.at(x, below) + sharp.at(right, below)) /
            4);
      }
    }
    EXPECT_GT(score(plan, test::to_frame(sharp)), score(plan, test::to_frame(blurred)));
  });
}

// Both axes count alike, so a picture and its transpose score alike; and the negative of a picture
// differs from it in zero frequency only, which no lever arm reaches where there is no taper.
TEST_P(Scores, DoNotCareAboutTransposeAndNegative) {
  each(cases(typical_specs(), {"natural8", "random16"}), 1, [&](const Case& tested, Plan& plan) {
    const int n = tested.spec.n;
    const test::Pixels pixels = tested.pixels(n, n);
    const double expected = score(plan, test::to_frame(pixels));
    test::Pixels transposed = pixels, negative = pixels;
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        transposed.at(x, y) = pixels.at(y, x);
        negative.at(x, y) = static_cast<std::uint16_t>(pixels.largest() - pixels.at(x, y));
      }
    }
    EXPECT_TRUE(score_matches(score(plan, test::to_frame(transposed)), expected, tested.spec,
                              2 * tolerance(tested.spec)));
    const bool holds_brightness =
        tested.spec.taper != Taper::none() || tested.spec.measure == Measure::entropy;
    if (holds_brightness) return;
    EXPECT_TRUE(score_matches(score(plan, test::to_frame(negative)), expected, tested.spec,
                              2 * tolerance(tested.spec)));
  });
}

}  // namespace
}  // namespace fathom::conformance
