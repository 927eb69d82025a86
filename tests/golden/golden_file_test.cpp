// SPDX-License-Identifier: Apache-2.0
// The golden file covers what it must; tests/conformance/scores.cpp holds every backend to it.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "engine/metric.hpp"
#include "tests/golden/golden_file.hpp"

namespace fathom::test {
namespace {

const std::vector<Golden>& golden() {
  static const auto values = read_golden(FATHOM_GOLDEN_FILE);
  return values;
}

TEST(GoldenFile, NamesMetricsCanonicallyAndOnce) {
  std::set<std::string> seen;
  for (const Golden& value : golden()) {
    EXPECT_EQ(MetricSpec::parse(value.spec).text(), value.spec);
    EXPECT_TRUE(seen.insert(value.spec + value.content + std::to_string(value.bits)).second)
        << value.spec << " " << value.content << value.bits << " stands there twice";
    EXPECT_EQ(value.values.size(), MetricSpec::parse(value.spec).outputs()) << value.spec;
    for (const double number : value.values)
      EXPECT_TRUE(std::isfinite(number) && number >= 0) << value.spec;
  }
}

TEST(GoldenFile, CoversEveryTransformSizeAndDepth) {
  std::map<std::string, int> not_zero;
  for (const Golden& value : golden()) {
    const MetricSpec spec = MetricSpec::parse(value.spec);
    const std::string what = std::string(to_string(spec.transform)) + " " + std::to_string(spec.n);
    const bool counts = value.values[0] > 0;
    if (spec.measure == Measure::rings) {
      not_zero[what + " rings"] += counts;
      continue;
    }
    if (spec.measure == Measure::entropy) {
      not_zero[what + (spec.band ? " entropy of a band" : " entropy")] += counts;
      continue;
    }
    not_zero[what + " " + std::to_string(value.bits) + " bit"] += counts;
    if (spec.power) not_zero[std::string(to_string(spec.transform)) + " power"] += counts;
    if (spec.band) not_zero[what + " band"] += counts;
  }
  for (const char* transform : {"fft", "walsh-paley", "walsh-sequency", "walsh-hadamard", "dct"}) {
    EXPECT_GT(not_zero[std::string(transform) + " power"], 0);
    for (int n = 8; n <= 512; n *= 2) {
      const std::string what = std::string(transform) + " " + std::to_string(n);
      EXPECT_GT(not_zero[what + " 8 bit"], 0) << what;
      EXPECT_GT(not_zero[what + " 16 bit"], 0) << what;
    }
  }
  for (int n = 8; n <= 512; n *= 2) {
    EXPECT_GT(not_zero["walsh-sequency " + std::to_string(n) + " band"], 0);
    EXPECT_GT(not_zero["fft " + std::to_string(n) + " band"], 0);
    EXPECT_GT(not_zero["dct " + std::to_string(n) + " entropy"], 0);
    EXPECT_GT(not_zero["dct " + std::to_string(n) + " entropy of a band"], 0);
    if (n > 256) continue;
    EXPECT_GT(not_zero["walsh-sequency " + std::to_string(n) + " rings"], 0);
    EXPECT_GT(not_zero["fft " + std::to_string(n) + " rings"], 0);
    EXPECT_GT(not_zero["dct " + std::to_string(n) + " rings"], 0);
  }
}

// phi = S / N^6, rounded once; and S stays below 2^61 (docs/metrics.md).
TEST(GoldenFile, ExactScoresAreTheirSums) {
  int checked = 0;
  for (const Golden& value : golden()) {
    const MetricSpec spec = MetricSpec::parse(value.spec);
    const bool is_moment = spec.measure == Measure::moment;
    EXPECT_EQ(value.sum.has_value(), is_moment && spec.is_exact()) << value.spec;
    if (!value.sum) continue;
    EXPECT_LT(*value.sum, std::uint64_t{1} << 61);
    EXPECT_EQ(value.values[0], static_cast<double>(*value.sum) / std::pow(spec.n, 6)) << value.spec;
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

}  // namespace
}  // namespace fathom::test
