// SPDX-License-Identifier: Apache-2.0
#include "engine/metric.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "engine/error.hpp"
#include "engine/window.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

struct Text {
  const char* written;
  const char* canonical;
};

class Canonical : public ::testing::TestWithParam<Text> {};

TEST_P(Canonical, IsWhatIsPrinted) {
  const MetricSpec spec = MetricSpec::parse(GetParam().written);
  EXPECT_EQ(spec.text(), GetParam().canonical);
  EXPECT_EQ(MetricSpec::parse(spec.text()), spec);
}

INSTANTIATE_TEST_SUITE_P(
    Texts, Canonical,
    ::testing::Values(
        Text{"fft", "fft:64:hann"}, Text{"fft:128", "fft:128:hann"},
        Text{"fft:none", "fft:64:none"}, Text{"fft:64:tukey=0", "fft:64:none"},
        Text{"fft:64:tukey=1", "fft:64:hann"}, Text{"fft:64:tukey=0.250", "fft:64:tukey=0.25"},
        Text{"fft:64:tukey=.5", "fft:64:tukey=0.5"}, Text{"fft:power", "fft:64:hann:power"},
        Text{"fft:64:hann:power:band=0-0.25", "fft:64:hann:power:band=0-0.25"},
        Text{"fft:band=0.0-1e-1", "fft:64:hann:band=0-0.1"},
        Text{"fft:band=1e-05-0.25", "fft:64:hann:band=1e-05-0.25"},
        Text{"fft:band=-0-0.25", "fft:64:hann:band=0-0.25"},
        Text{"fft:band=0.1-0.30000000000000004", "fft:64:hann:band=0.1-0.30000000000000004"},
        Text{"walsh-paley", "walsh-paley:64"}, Text{"walsh-sequency:8", "walsh-sequency:8"},
        Text{"walsh-hadamard:512:none", "walsh-hadamard:512"},
        Text{"walsh-sequency:64:hann", "walsh-sequency:64:hann"},
        Text{"walsh-sequency:64:band=0-0.25", "walsh-sequency:64:band=0-0.25"},
        Text{"walsh-sequency:none:power", "walsh-sequency:64:power"}, Text{"dct", "dct:64"},
        Text{"dct:none:power", "dct:64:power"}, Text{"dct:entropy", "dct:64:entropy"},
        Text{"dct:32:rings=4", "dct:32:rings=4"},
        Text{"dct:32:none:entropy:band=0-.25", "dct:32:entropy:band=0-0.25"}));

TEST(Metric, EveryCombinationReadsBackAsItself) {
  std::set<std::string> texts;
  std::size_t count = 0;
  for (const Transform transform : {Transform::fft, Transform::walsh_paley,
                                    Transform::walsh_sequency, Transform::walsh_hadamard}) {
    for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
      for (const double fraction : {0.0, 1.0, 0.25, 1.0 / 3, 1e-9}) {
        for (const bool power : {false, true}) {
          for (const std::optional<Band>& band :
               {std::optional<Band>(), {{0, 0.25}}, {{0.1, 1.0 / 3}}, {{1e-7, 1}}}) {
            const bool ordered =
                transform == Transform::fft || transform == Transform::walsh_sequency;
            if (band && !ordered) continue;
            const MetricSpec spec{transform, n, {fraction}, power, band};
            EXPECT_EQ(MetricSpec::parse(spec.text()), spec) << spec.text();
            EXPECT_EQ(MetricSpec::parse(spec.text()).text(), spec.text());
            texts.insert(spec.text());
            ++count;
          }
        }
      }
    }
  }
  EXPECT_EQ(texts.size(), count) << "two metrics share a text";
}

TEST(Metric, NIsTakenFromTheTextFirst) {
  EXPECT_EQ(MetricSpec::parse("fft", 128).n, 128);
  EXPECT_EQ(MetricSpec::parse("fft:32", 128).n, 32);
  EXPECT_TRUE(MetricSpec::names_n("fft:32"));
  EXPECT_TRUE(MetricSpec::names_n("fft:32:hann"));
  EXPECT_FALSE(MetricSpec::names_n("fft"));
  EXPECT_FALSE(MetricSpec::names_n("fft:hann"));
}

TEST(Metric, StandardIsTheOneOfTheThesis) {
  EXPECT_EQ(MetricSpec::standard(Transform::fft, 64).text(), "fft:64:hann");
  EXPECT_EQ(MetricSpec::standard(Transform::walsh_paley, 32).text(), "walsh-paley:32");
}

class Refused : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(Refused, SaysWhatIsWrong) {
  const auto& [text, named] = GetParam();
  test::expect_error(ErrorCode::bad_argument, [&] { MetricSpec::parse(text); }, {named});
}

INSTANTIATE_TEST_SUITE_P(
    Texts, Refused,
    ::testing::Values(
        std::pair("", "walsh-sequency"), std::pair("FFT", "no transform \"FFT\""),
        std::pair("walsh", "walsh-paley"), std::pair("fft ", "no transform"),
        std::pair("fft:", "\"\""), std::pair("fft:65", "65"), std::pair("fft:4", "4"),
        std::pair("fft:1024", "1024"), std::pair("fft:-64", "-64"), std::pair("fft:0", "0"),
        std::pair("fft:64.0", "64.0"), std::pair("fft:99999999999999", "99999999999999"),
        std::pair("fft:64:64", "\"64\""), std::pair("fft:64:hanning", "hanning"),
        std::pair("fft:64:hann:hann", "\"hann\""), std::pair("fft:64:power:hann", "\"hann\""),
        std::pair("fft:64:band=0-0.25:power", "\"power\""), std::pair("fft:64:tukey", "tukey"),
        std::pair("fft:64:tukey=", "tukey="), std::pair("fft:64:tukey=x", "tukey=x"),
        std::pair("fft:64:tukey=-0.1", "fraction"), std::pair("fft:64:tukey=1.1", "fraction"),
        std::pair("fft:64:tukey=nan", "fraction"), std::pair("fft:64:tukey=inf", "fraction"),
        std::pair("fft:band=", "band="), std::pair("fft:band=0.25", "band=0.25"),
        std::pair("fft:band=0.25-", "band=0.25-"), std::pair("fft:band=0.3-0.2", "LO < HI"),
        std::pair("fft:band=0.2-0.2", "LO < HI"), std::pair("fft:band=-0.1-0.2", "0 <= LO"),
        std::pair("fft:band=0-1.5", "HI <= 1"), std::pair("fft:band=nan-0.2", "0 <= LO"),
        std::pair("fft:band=0-0.2-0.3", "band=0-0.2-0.3"), std::pair("fft:64:", "\"\""),
        std::pair("walsh-paley:band=0-0.25", "walsh-sequency"),
        std::pair("walsh-hadamard:64:band=0-0.25", "walsh-sequency"),
        std::pair("dct:hann", "no taper"), std::pair("dct:64:tukey=0.5:entropy", "no taper"),
        std::pair("fft:64:entropy", "only dct"), std::pair("walsh-sequency:entropy", "only dct"),
        std::pair("dct:64:power:entropy", "leave power out"),
        std::pair("dct:64:entropy:power", "\"power\""),
        std::pair("dct:64:entropy:rings=4", "\"rings=4\""),
        std::pair("dct:64:band=0-0.25:entropy", "\"entropy\""),
        std::pair("dct:64:entropy:band=0-0.001", "none of the 64 x 64")));

TEST(Band, CountsRadiiOverLowUpToHigh) {
  const Band band{0.125, 0.25};  // 8 < r <= 16 for fft:64, 16 < r <= 32 for walsh-sequency:64
  EXPECT_FALSE(band.contains(Transform::fft, 64, 64));
  EXPECT_TRUE(band.contains(Transform::fft, 64, 65));
  EXPECT_TRUE(band.contains(Transform::fft, 64, 256));
  EXPECT_FALSE(band.contains(Transform::fft, 64, 257));
  EXPECT_FALSE(band.contains(Transform::walsh_sequency, 64, 256));
  EXPECT_TRUE(band.contains(Transform::walsh_sequency, 64, 257));
  EXPECT_TRUE(band.contains(Transform::walsh_sequency, 64, 1024));
  EXPECT_FALSE(band.contains(Transform::walsh_sequency, 64, 1025));
  EXPECT_FALSE((Band{0, 0.5}.contains(Transform::fft, 64, 0))) << "zero frequency never counts";
}

TEST(Metric, ExactnessIsForPlainWalsh) {
  EXPECT_TRUE(MetricSpec::parse("walsh-paley:512").is_exact());
  EXPECT_TRUE(MetricSpec::parse("walsh-sequency:64:band=0-0.25").is_exact());
  EXPECT_FALSE(MetricSpec::parse("walsh-paley:64:power").is_exact());
  EXPECT_FALSE(MetricSpec::parse("walsh-paley:64:hann").is_exact());
  EXPECT_FALSE(MetricSpec::parse("fft:64:none").is_exact());
}

TEST(ErrorCodes, HaveTheirNames) {
  EXPECT_STREQ(to_string(ErrorCode::bad_argument), "bad_argument");
  EXPECT_STREQ(to_string(ErrorCode::cancelled), "cancelled");
  std::set<std::string> names;
  for (int code = 0; code <= static_cast<int>(ErrorCode::cancelled); ++code) {
    names.insert(to_string(static_cast<ErrorCode>(code)));
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(ErrorCode::cancelled) + 1);
}

}  // namespace
}  // namespace fathom
