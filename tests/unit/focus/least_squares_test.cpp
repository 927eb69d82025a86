// SPDX-License-Identifier: Apache-2.0
#include "focus/least_squares.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "focus/distributions.hpp"

namespace fathom {
namespace {

// y = a exp(b t) through points that lie on it.
TEST(MinimizeSquares, FindsTheParametersThatMadeThePoints) {
  constexpr double kA = 2.5, kB = -0.7;
  const auto y = [](double t) { return kA * std::exp(kB * t); };
  const ResidualModel model{6,
                            [&](std::span<const double> x, std::span<double> residuals) {
                              for (std::size_t i = 0; i < residuals.size(); ++i) {
                                const auto t = static_cast<double>(i);
                                residuals[i] = y(t) - x[0] * std::exp(x[1] * t);
                              }
                            },
                            [&](std::span<const double> x, Matrix& jacobian) {
                              for (std::size_t i = 0; i < jacobian.rows(); ++i) {
                                const auto t = static_cast<double>(i);
                                jacobian(i, 0) = -std::exp(x[1] * t);
                                jacobian(i, 1) = -x[0] * t * std::exp(x[1] * t);
                              }
                            }};
  const auto x = minimize_squares(model, {1, 0}, 1e-15);
  EXPECT_NEAR(x[0], kA, 1e-12);
  EXPECT_NEAR(x[1], kB, 1e-12);
}

Matrix matrix(const std::vector<std::vector<double>>& rows) {
  Matrix all(rows.size(), rows[0].size());
  for (std::size_t i = 0; i < all.rows(); ++i) {
    for (std::size_t j = 0; j < all.columns(); ++j) all(i, j) = rows[i][j];
  }
  return all;
}

// A straight line through (0, 1), (1, 2), (2, 4), by hand: 5/6 + 3/2 t.
TEST(SolveSquares, IsTheLineOfTheTextbook) {
  const std::vector<double> values = {1, 2, 4};
  const auto x = solve_squares(matrix({{1, 0}, {1, 1}, {1, 2}}), values);
  ASSERT_TRUE(x);
  EXPECT_NEAR((*x)[0], 5.0 / 6, 1e-14);
  EXPECT_NEAR((*x)[1], 1.5, 1e-14);
}

TEST(SolveSquares, RefusesWhatDeterminesNothing) {
  const std::vector<double> values = {1, 2};
  EXPECT_FALSE(solve_squares(matrix({{1, 2}, {2, 4}}), values));
  EXPECT_FALSE(solve_squares(matrix({{1, 0}, {0, std::nan("")}}), values));
  const std::vector<double> endless = {1, std::numeric_limits<double>::infinity()};
  EXPECT_FALSE(solve_squares(matrix({{1, 0}, {0, 1}}), endless));
}

TEST(NormalInverse, IsTheCovarianceOfTheLine) {
  const auto line = normal_inverse(matrix({{1, 0}, {1, 1}, {1, 2}}));  // J'J = {{3, 3}, {3, 5}}
  EXPECT_TRUE(line.is_certain);
  EXPECT_NEAR(line.matrix(0, 0), 5.0 / 6, 1e-14);
  EXPECT_NEAR(line.matrix(0, 1), -0.5, 1e-14);
  EXPECT_NEAR(line.matrix(1, 0), -0.5, 1e-14);
  EXPECT_NEAR(line.matrix(1, 1), 0.5, 1e-14);
  EXPECT_FALSE(normal_inverse(matrix({{1, 2}, {2, 4}, {3, 6}})).is_certain);
}

// Tables of the F distribution: the upper 1 % points.
TEST(FisherBeyond, IsWhatTheTablesSay) {
  EXPECT_NEAR(fisher_beyond(99.00, 2, 2), 0.01, 1e-5);
  EXPECT_NEAR(fisher_beyond(7.56, 2, 10), 0.01, 2e-5);
  EXPECT_NEAR(fisher_beyond(4.98, 2, 60), 0.01, 3e-5);
  EXPECT_EQ(fisher_beyond(0, 2, 10), 1);
}

}  // namespace
}  // namespace fathom
