// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "engine/error.hpp"

namespace fathom::reproduce {
namespace {

TEST(Summary, IsThatOfATextbook) {
  const std::vector<double> values = {2, 4, 4, 4, 5, 5, 7, 9};
  const Summary s = summarise(values);
  EXPECT_EQ(s.count, 8);
  EXPECT_DOUBLE_EQ(s.mean, 5);
  EXPECT_DOUBLE_EQ(s.sd, std::sqrt(32.0 / 7));
  EXPECT_EQ(s.least, 2);
  EXPECT_EQ(s.most, 9);
  EXPECT_DOUBLE_EQ(s.half_range_part(), 0.7);
}

TEST(Summary, OfNothingIsNothing) {
  EXPECT_EQ(summarise({}).count, 0);
  EXPECT_EQ(summarise({}).half_range_part(), 0);
  EXPECT_EQ(summarise(std::vector<double>{3}).sd, 0);
}

// Anscombe (1973), first set: y = 3.00 + 0.500 x, R^2 = 0.67.
TEST(Line, FitsAnscombe) {
  const std::vector<double> x = {10, 8, 13, 9, 11, 14, 6, 4, 12, 7, 5};
  const std::vector<double> y = {8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68};
  const Line line = fit_line(x, y);
  EXPECT_NEAR(line.intercept, 3.0001, 1e-4);
  EXPECT_NEAR(line.slope, 0.5001, 1e-4);
  EXPECT_NEAR(line.r_squared, 0.6665, 1e-4);
  EXPECT_NEAR(line.at(10), 8.001, 1e-3);
}

TEST(Line, RefusesWhatDeterminesNone) {
  EXPECT_THROW(fit_line(std::vector<double>{1, 1}, std::vector<double>{1, 2}), Error);
  EXPECT_THROW(fit_line(std::vector<double>{1, 2}, std::vector<double>{1}), Error);
}

TEST(Roughness, IgnoresSlopesAndFindsTheNoise) {
  std::vector<double> slope, noisy;
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.01);
  for (int i = 0; i < 4000; ++i) {
    slope.push_back(7 - 0.3 * i);
    noisy.push_back(1 + 1e-4 * i + noise(random));
  }
  EXPECT_NEAR(roughness(slope), 0, 1e-12);
  EXPECT_NEAR(roughness(noisy), 0.01, 0.0005);
  EXPECT_EQ(roughness(std::vector<double>{1, 2}), 0);
}

TEST(Ratio, IsSymmetricInLogarithms) {
  const Ratio ratio = mean_ratio(std::vector<double>{1, 4});
  EXPECT_EQ(ratio.count, 2);
  EXPECT_NEAR(ratio.value, 2, 1e-12);
  EXPECT_NEAR(ratio.low * ratio.high, 4, 1e-9);
  // ln 4 / sqrt 2 / sqrt 2 = ln 2, and Student's t of one degree of freedom is 12.706.
  EXPECT_NEAR(std::log(ratio.high / ratio.value), 12.706 * std::log(2.0), 1e-3);
  const Ratio single = mean_ratio(std::vector<double>{3});
  EXPECT_NEAR(single.low, 3, 1e-12);
  EXPECT_NEAR(single.high, 3, 1e-12);
}

}  // namespace
}  // namespace fathom::reproduce
