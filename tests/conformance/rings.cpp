// SPDX-License-Identifier: Apache-2.0
// Ring powers: the numbers, what the subtraction of the mean is for, and that K values of a window
// are kept apart whatever the batch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/error.hpp"
#include "engine/measure.hpp"
#include "tests/conformance/spectra.hpp"
#include "tests/conformance/suite.hpp"
#include "tests/golden/golden_file.hpp"
#include "tests/support/canary.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/oracle_compare.hpp"

namespace fathom::conformance {
namespace {

using test::bit_equal;
using test::Guarded;
using test::ring_matches;

class RingPowers : public Conformance {
 protected:
  /// Values of a batch, window by window; fails if the plan wrote beside them.
  static std::vector<double> values_of(Plan& plan, const Frame& frame,
                                       const std::vector<Window>& windows) {
    Guarded<double> values(windows.size() * plan.spec().outputs());
    plan.score(frame, windows, values.span());
    EXPECT_TRUE(values.intact()) << "score() wrote beyond its output";
    return {values.span().begin(), values.span().end()};
  }
  static std::vector<double> values_of(Plan& plan, const Frame& frame) {
    return values_of(plan, frame, {{0, 0, plan.spec().n}});
  }

  /// Of the picture that the case's window fills; remembered, because the oracle takes its time.
  static const std::vector<double>& oracle_values(const Case& tested) {
    static std::map<std::string, std::vector<double>> known;
    const auto [entry, is_new] = known.try_emplace(tested.text());
    if (is_new) entry->second = values_of(*oracle(tested.spec), tested.frame());
    return entry->second;
  }

  void expect_match(const MetricSpec& spec, const std::vector<double>& got,
                    const std::vector<double>& expected) const {
    ASSERT_EQ(got.size(), expected.size());
    const double grain = test::quantisation(spec);
    const double tolerance = GetParam().is_reference() ? 1e-12 : test::kRingTolerance;
    for (std::size_t k = 0; k < got.size(); ++k)
      EXPECT_TRUE(ring_matches(got[k], expected[k], spec, grain, tolerance)) << "value " << k;
  }
};
FATHOM_EVERY_DEVICE(RingPowers);

TEST_P(RingPowers, MatchTheGoldenValues) {
  std::vector<Case> all;
  std::map<std::string, std::vector<double>> expected;
  for (const test::Golden& golden : test::read_golden(golden_file())) {
    const MetricSpec spec = MetricSpec::parse(golden.spec);
    if (spec.measure != Measure::rings) continue;
    all.push_back({spec, golden.content, golden.bits, golden.seed});
    expected[all.back().text()] = golden.values;
  }
  each(all, 1, [&](const Case& tested, Plan& plan) {
    expect_match(tested.spec, values_of(plan, tested.frame()), expected.at(tested.text()));
  });
}

/// Every size, depth, taper and option, most of them with as many rings as 16: each other number is
/// a kernel of its own, which software devices compile for seconds.
std::vector<Case> wide_cases() {
  std::vector<Case> all;
  for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
    const std::string side = ":" + std::to_string(n);
    const std::string most = ":rings=" + std::string(n == 8 ? "4" : n == 16 ? "8" : "16");
    std::vector<std::string> specs = {"fft" + side + ":hann" + most, "walsh-sequency" + side + most,
                                      "dct" + side + most};
    if (n <= 128) {
      specs.push_back("fft" + side + ":tukey=0.3" + most);
      specs.push_back("fft" + side + ":hann:power" + most);
      specs.push_back("fft" + side + ":none:power" + most);
    }
    if (n == 64) {
      specs.push_back("fft:64:hann:power:band=0.1-0.45" + most);
      specs.push_back("fft:64:hann:power:rings=32");
      specs.push_back("walsh-sequency:64:hann" + most);
      specs.push_back("walsh-sequency:64:power" + most);
      specs.push_back("walsh-sequency:64:band=0.1-0.4" + most);
      specs.push_back("dct:64:power:band=0.1-0.4" + most);
    }
    std::vector<std::string> pictures;
    for (const std::string& content : test::contents()) {
      if (n > 64 && content != "natural" && content != "nearly-flat" && content != "binary")
        continue;
      for (const char* bits : {"8", "16"}) pictures.push_back(content + bits);
    }
    if (n == kLargestWindow) pictures = {"nearly-flat8", "natural16"};
    for (Case& tested : cases(specs, pictures, 2000 + n)) all.push_back(std::move(tested));
  }
  return all;
}

TEST_P(RingPowers, MatchTheReference) {
  if (GetParam().is_reference()) GTEST_SKIP() << "the oracle itself; the golden values hold it";
  each(wide_cases(), 1, [&](const Case& tested, Plan& plan) {
    expect_match(tested.spec, values_of(plan, tested.frame()), oracle_values(tested));
  });
}

const std::vector<std::string> kTypical = {"fft:16:hann:rings=4",
                                           "fft:32:none:power:rings=5",
                                           "fft:64:hann:power:rings=16",
                                           "fft:32:tukey=0.3:band=0-0.25:rings=3",
                                           "walsh-sequency:16:rings=4",
                                           "walsh-sequency:64:rings=8",
                                           "walsh-sequency:32:hann:power:rings=8",
                                           "dct:16:rings=4",
                                           "dct:64:power:rings=8"};
const std::vector<std::string> kLarge = {"fft:128:hann:power:rings=32",
                                         "walsh-sequency:128:rings=8", "fft:256:hann:rings=16",
                                         "walsh-sequency:512:rings=8"};

std::vector<std::string> all_sizes(bool is_reference) {
  std::vector<std::string> specs = kTypical;
  if (!is_reference) specs.insert(specs.end(), kLarge.begin(), kLarge.end());
  return specs;
}

// Windows of a batch lie beside each other, their values too; nothing of a neighbour may show.
TEST_P(RingPowers, DoNotDependOnTheBatch) {
  each(cases(all_sizes(GetParam().is_reference()), {"random8", "natural16"}), 40,
       [&](const Case& tested, Plan& plan) {
         const int n = tested.spec.n;
         const Frame frame = tested.frame(n + 39, n + 5);
         std::vector<Window> windows;
         for (int i = 0; i < (n > 64 ? 5 : 37); ++i) windows.push_back({i, i % 5, n});
         const auto together = values_of(plan, frame, windows);
         const std::size_t outputs = tested.spec.outputs();
         for (std::size_t i = 0; i<windows.size(); i += n> 64 ? 2 : 7) {
           const auto alone = values_of(plan, test::cropped(frame, windows[i]));
           for (std::size_t k = 0; k < outputs; ++k)
             ASSERT_TRUE(bit_equal(together[i * outputs + k], alone[k])) << i << " value " << k;
         }
         expect_match(tested.spec, {together.begin(), together.begin() + outputs},
                      values_of(*oracle(tested.spec), test::cropped(frame, windows[0])));
       });
}

TEST_P(RingPowers, SurviveTicketsOutOfOrder) {
  each(cases({"fft:16:hann:rings=8", "walsh-sequency:16:rings=8"}, {"random8"}), 9,
       [&](const Case& tested, Plan& plan) {
         const int n = tested.spec.n;
         const Frame frames[2] = {tested.frame(n + 8, n), tested.frame(n + 9, n + 1)};
         std::vector<Window> windows;
         for (int x = 0; x < 9; ++x) windows.push_back({x, 0, n});
         std::vector<Guarded<double>> values(2, Guarded<double>(9 * tested.spec.outputs()));
         const auto first = plan.submit(frames[0], windows, values[0].span());
         const auto second = plan.submit(frames[1], windows, values[1].span());
         plan.wait(second);
         plan.wait(first);
         for (int i = 0; i < 2; ++i) {
           EXPECT_TRUE(values[i].intact());
           const auto again = values_of(plan, frames[i], windows);
           EXPECT_TRUE(std::ranges::equal(again, values[i].span()));
         }
       });
}

// Of a flat window the mean is all that there is: what stays is rounding, for power as well, in
// whatever light.
TEST_P(RingPowers, OfABlankWindowAreNothing) {
  each(cases({"fft:64:hann:power:rings=16", "fft:32:tukey=0.5:rings=16",
              "walsh-sequency:64:rings=16", "fft:128:hann:rings=16", "dct:32:rings=8"},
             {"flat8", "full8", "flat16", "full16", "zero16"}),
       1, [&](const Case& tested, Plan& plan) {
         expect_match(tested.spec, values_of(plan, tested.frame()),
                      std::vector<double>(tested.spec.outputs(), 0.0));
       });
}

// More light is no change: the mean goes before the taper.
TEST_P(RingPowers, DoNotHoldBrightness) {
  each(cases({"fft:64:hann:power:rings=16", "fft:16:hann:rings=8"}, {"natural8"}), 1,
       [&](const Case& tested, Plan& plan) {
         test::Pixels dark = tested.pixels(tested.spec.n, tested.spec.n);
         dark.bits = 16;
         test::Pixels bright = dark;
         for (auto& value : bright.values) value = static_cast<std::uint16_t>(value + 40'000);
         expect_match(tested.spec, values_of(plan, test::to_frame(bright)),
                      values_of(plan, test::to_frame(dark)));
       });
}

// White noise of variance s^2 has s^2 SUM w^2 / N^4 in every ring but the first.
TEST_P(RingPowers, OfWhiteNoiseAreLevel) {
  each(cases({"fft:64:hann:power:rings=16", "fft:64:none:power:rings=16"}, {"random8"}), 64,
       [&](const Case& tested, Plan& plan) {
         const int n = tested.spec.n;
         const Frame frame = tested.frame(8 * n, 8 * n);
         const auto windows = window_grid(8 * n, 8 * n, {0, 0, n}, n);
         const auto values = values_of(plan, frame, windows);
         // Of whole levels from 0 to 255, each as likely.
         const double level = (256.0 * 256.0 - 1) * test::quantisation(tested.spec);
         const Rings rings(tested.spec);
         for (int k = 1; k < 16; ++k) {
           // Four standard deviations: a coefficient's power scatters by itself, hann makes about
           // 1.5 neighbours one, and half of the plane mirrors the other half.
           const double coefficients =
               rings.coefficients()[k] * static_cast<double>(windows.size()) / (2 * 1.5);
           double mean = 0;
           for (std::size_t i = 0; i < windows.size(); ++i) mean += values[i * 16 + k];
           EXPECT_NEAR(mean / static_cast<double>(windows.size()) / level, 1,
                       4 / std::sqrt(coefficients))
               << k;
         }
       });
}

// They are the means of the device's own spectrum, whichever way they are computed.
TEST_P(RingPowers, AreTheMeansOfTheSpectrum) {
  each(cases(kTypical, {"random8", "natural16"}), 1, [&](const Case& tested, Plan& plan) {
    const Frame frame = tested.frame();
    const auto spectrum = spectrum_of(*oracle(tested.spec.plain()), frame);
    std::vector<double> expected(tested.spec.outputs());
    SpectrumMeasure measure(tested.spec);
    measure(spectrum.values(), expected);
    const auto got = values_of(plan, frame);
    const double grain = test::quantisation(tested.spec);
    for (std::size_t k = 0; k < got.size(); ++k)
      EXPECT_TRUE(ring_matches(got[k], expected[k], tested.spec, grain)) << k;
  });
}

TEST_P(RingPowers, NeedRoomForEveryValue) {
  each(cases({"fft:16:hann:rings=8", "walsh-sequency:16:rings=8"}, {"random8"}), 2,
       [&](const Case& tested, Plan& plan) {
         const Frame frame = tested.frame();
         const std::vector<Window> windows(2, Window{0, 0, tested.spec.n});
         const std::size_t room = 2 * tested.spec.outputs();
         for (const std::size_t wrong : {std::size_t{2}, room - 1, room + 1, std::size_t{0}}) {
           Guarded<double> values(wrong);
           test::expect_error(ErrorCode::bad_argument,
                              [&] { plan.score(frame, windows, values.span()); });
           EXPECT_TRUE(values.intact());
         }
         test::expect_error(ErrorCode::bad_argument, [&] { plan.score(frame, windows[0]); });
       });
}

}  // namespace
}  // namespace fathom::conformance
