// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/samples.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace fathom::cli {
namespace {

TEST(Samples, MedianAndQuartilesAreTimings) {
  const std::vector<Sample> samples = {{5, 1, 1}, {1, 1, 1}, {4, 1, 1}, {2, 1, 1}, {90, 1, 1}};
  const WindowTime time = summary_of(samples);
  EXPECT_EQ(time.min_us, 1);
  EXPECT_EQ(time.lower_quartile_us, 2);
  EXPECT_EQ(time.median_us, 4);
  EXPECT_EQ(time.upper_quartile_us, 5);
  EXPECT_EQ(time.max_us, 90);
}

TEST(Samples, OrderIsKeptHoweverFewThereAre) {
  std::vector<Sample> samples;
  for (int count = 1; count < 12; ++count) {
    samples.push_back({static_cast<double>(count * 7 % 12), 1, 1});
    const WindowTime time = summary_of(samples);
    EXPECT_LE(time.min_us, time.lower_quartile_us);
    EXPECT_LE(time.lower_quartile_us, time.median_us);
    EXPECT_LE(time.median_us, time.upper_quartile_us);
    EXPECT_LE(time.upper_quartile_us, time.max_us);
  }
}

TEST(Samples, ShareIsOfAllTimingsTogether) {
  // 0.1 s of which the thread had half, 0.9 s of which it had all.
  const std::vector<Sample> samples = {{1, 0.1, 0.05}, {1, 0.9, 0.9}};
  EXPECT_DOUBLE_EQ(summary_of(samples).processor_share, 0.95);
  EXPECT_EQ(summary_of(std::vector<Sample>{{1, 0.1, 0.1001}}).processor_share, 1)
      << "two clocks never agree to the last digit";
}

TEST(Samples, BusyIsWhoHadLessThanMostOfAProcessor) {
  EXPECT_FALSE(is_busy(1));
  EXPECT_FALSE(is_busy(0.951));
  EXPECT_TRUE(is_busy(0.949));
  EXPECT_NE(busy_text(0.624).find(" 62 % "), std::string::npos) << busy_text(0.624);
}

TEST(Samples, BytesAreThoseOfTheWindowsPixels) {
  EXPECT_DOUBLE_EQ(gigabytes_per_s(64, 1, 1), 4.096);
  EXPECT_DOUBLE_EQ(gigabytes_per_s(64, 2, 4), 2.048);
}

}  // namespace
}  // namespace fathom::cli
