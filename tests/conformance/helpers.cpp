// SPDX-License-Identifier: Apache-2.0
// The judges judged: a comparison that lets NaN through, or a canary that does not sing, would make
// the whole suite worthless.
#include <gtest/gtest.h>

#include <limits>

#include "tests/conformance/suite.hpp"
#include "tests/support/canary.hpp"
#include "tests/support/oracle_compare.hpp"

namespace fathom::conformance {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Helpers, NaNAndInfinityNeverPass) {
  const MetricSpec exact = MetricSpec::parse("walsh-paley:64");
  const MetricSpec rounded = MetricSpec::parse("fft:64");
  for (const double bad : {kNaN, -kNaN, kInfinity, -kInfinity}) {
    EXPECT_FALSE(test::bit_equal(bad, bad));
    EXPECT_FALSE(test::bit_equal(bad, 1));
    EXPECT_FALSE(test::within(bad, bad, 1));
    EXPECT_FALSE(test::within(1, bad, 1));
    EXPECT_FALSE(test::within(bad, 1, kInfinity));
    EXPECT_FALSE(test::within(1, 1, kNaN));
    for (const MetricSpec& spec : {exact, rounded}) {
      EXPECT_FALSE(test::score_matches(bad, bad, spec, test::score_tolerance(spec)));
      EXPECT_FALSE(test::score_matches(bad, 1, spec, test::score_tolerance(spec)));
      EXPECT_FALSE(test::score_matches(1, bad, spec, test::score_tolerance(spec)));
      EXPECT_FALSE(test::score_matches(bad, 0, spec, test::score_tolerance(spec)));
    }
    const std::vector<std::complex<double>> good = {1, 2}, one_bad = {1, {2, bad}};
    EXPECT_FALSE(test::spectrum_matches(one_bad, good, 1));
    EXPECT_FALSE(test::spectrum_matches(good, one_bad, 1));
    EXPECT_FALSE(test::spectrum_matches(one_bad, one_bad, 1));
  }
}

TEST(Helpers, TolerancesAreWhatTheProjectOwes) {
  EXPECT_EQ(test::score_tolerance(MetricSpec::parse("fft:128")), 2e-6);
  EXPECT_EQ(test::score_tolerance(MetricSpec::parse("fft:256")), 5e-6);
  EXPECT_EQ(test::score_tolerance(MetricSpec::parse("walsh-sequency:512:band=0-0.25")), 0);
  EXPECT_EQ(test::score_tolerance(MetricSpec::parse("walsh-paley:64:power")), 2e-6);
  EXPECT_EQ(test::score_tolerance(MetricSpec::parse("walsh-paley:64:hann")), 2e-6);

  const MetricSpec fft = MetricSpec::parse("fft:64");
  EXPECT_TRUE(test::score_matches(1 + 1.9e-6, 1, fft, 2e-6));
  EXPECT_FALSE(test::score_matches(1 + 2.1e-6, 1, fft, 2e-6));
  EXPECT_FALSE(test::score_matches(1 - 2.1e-6, 1, fft, 2e-6));
  EXPECT_FALSE(test::bit_equal(1, std::nextafter(1, 2)));
  EXPECT_FALSE(test::bit_equal(0.0, -0.0));
  EXPECT_FALSE(test::spectrum_matches(std::vector<std::complex<double>>(2),
                                      std::vector<std::complex<double>>(3), 1));
}

// The absolute bound is for true zeros only: the least picture that is not flat is judged
// relatively.
TEST(Helpers, SmallScoresAreJudgedRelatively) {
  for (const char* text :
       {"fft:8:hann", "fft:512:hann", "fft:64:none:power", "walsh-paley:64:power"}) {
    const MetricSpec spec = MetricSpec::parse(text);
    const double least = test::one_grey_level(spec);
    EXPECT_GT(least, 0);
    EXPECT_FALSE(test::score_matches(least * 1e-3 * (1 + 3e-6), least * 1e-3, spec, 2e-6)) << text;
    EXPECT_TRUE(test::score_matches(0, least * 1e-17, spec, 2e-6)) << text;
    EXPECT_FALSE(test::score_matches(least * 3e-6, 0, spec, 2e-6)) << text;
  }
  // 1/N^4 * 1/2 * SUM 1/N^2 (u^2 + v^2) for N = 8: SUM u^2 over -4..3 is 44, times 2 * 8.
  EXPECT_DOUBLE_EQ(test::one_grey_level(MetricSpec::parse("fft:8:none")), 704.0 / 64 / 2 / 4096);
}

TEST(Helpers, CanariesSing) {
  test::Guarded<double> guarded(3);
  EXPECT_TRUE(guarded.intact());
  EXPECT_TRUE(std::isnan(guarded[0]) && std::isnan(guarded[2]));
  guarded[2] = 1;
  EXPECT_TRUE(guarded.intact());
  guarded.span().data()[3] = 1;
  EXPECT_FALSE(guarded.intact());
  test::Guarded<std::complex<double>> before(3);
  before.span().data()[-1] = 0;
  EXPECT_FALSE(before.intact());
}

TEST(Helpers, PicturesAreAlwaysTheSame) {
  test::SplitMix64 noise(0);
  EXPECT_EQ(noise.next(), 0xe220a8397b1dcdafU);  // Vigna's published first value
  for (const std::string& content : test::contents()) {
    for (const int bits : {8, 16}) {
      const auto pixels = test::make_pixels(content, bits, 33, 20, 7);
      EXPECT_EQ(pixels.values, test::make_pixels(content, bits, 33, 20, 7).values) << content;
      ASSERT_EQ(pixels.values.size(), 33U * 20) << content;
      for (const auto value : pixels.values) ASSERT_LE(value, pixels.largest()) << content;
    }
  }
  EXPECT_NE(test::make_pixels("random", 8, 8, 8, 1).values,
            test::make_pixels("random", 8, 8, 8, 2).values);
  EXPECT_THROW(test::make_pixels("sunset", 8, 8, 8, 1), std::invalid_argument);
}

TEST(Helpers, CasesNameThemselves) {
  const auto all = cases({"fft:64", "walsh-paley:8"}, {"nearly-flat8", "random16"}, 3);
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(all[0].text(), "fft:64:hann/nearly-flat8/seed=3");
  EXPECT_EQ(all[3].text(), "walsh-paley:8/random16/seed=3");
}

}  // namespace
}  // namespace fathom::conformance
