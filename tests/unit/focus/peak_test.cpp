// SPDX-License-Identifier: Apache-2.0
// Peaks whose place is known beforehand: exact shapes, and shapes under noise of known strength.
#include "focus/peak.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "focus/noise.hpp"

namespace fathom {
namespace {

using Curve = std::vector<Evaluation>;

double gaussian(double z) { return std::exp2(-z * z); }
double lorentzian(double z) { return 1 / (1 + z * z); }

constexpr double kFloor = 0.2, kWidth = 10;

Curve curve_of(double (*shape)(double), double peak, const std::vector<double>& positions) {
  Curve curve;
  for (const double p : positions) {
    curve.push_back(
        {static_cast<int>(curve.size()) + 1, p, kFloor + 0.8 * shape((p - peak) / kWidth)});
  }
  return curve;
}

std::vector<double> even(double spacing) {
  std::vector<double> positions;
  for (double p = -60; p <= 60; p += spacing) positions.push_back(p);
  return positions;
}

const std::vector<double> kUneven = {-60, -31, -17, -11, -8, -3, 1, 2.5, 9, 12, 20, 44, 60};

Peak fit(const Curve& curve, const ScoreNoise& noise = {}) {
  return fit_peak(curve, FocusCurve(curve).best(), kFloor, noise);
}

TEST(FitPeak, FindsExactShapesBetweenThePositions) {
  for (const auto& positions : {even(4), even(7), kUneven}) {
    for (double peak = -5; peak <= 5; peak += 0.37) {
      const Peak g = fit(curve_of(gaussian, peak, positions));
      EXPECT_EQ(g.shape, PeakShape::gaussian) << peak;
      EXPECT_NEAR(g.position, peak, 1e-4) << peak;
      EXPECT_NEAR(g.half_width, kWidth, 1e-3) << peak;
      EXPECT_NEAR(g.score, 1, 1e-4) << peak;
      EXPECT_GT(g.r_squared, 0.9999) << peak;
      const Peak l = fit(curve_of(lorentzian, peak, positions));
      EXPECT_EQ(l.shape, PeakShape::lorentzian) << peak;
      EXPECT_NEAR(l.position, peak, 1e-4) << peak;
      EXPECT_NEAR(l.half_width, kWidth, 1e-3) << peak;
    }
  }
}

TEST(FitPeak, ThreePointsGiveTheVertexOfTheirParabola) {
  for (const double peak : {-1.4, -0.2, 0.0, 0.9, 1.3}) {
    for (const double right : {2.0, 3.0, 7.0}) {
      Curve curve;
      for (const double p : {-3.0, 0.0, right})
        curve.push_back({0, p, 5 - 0.03 * (p - peak) * (p - peak)});
      if (FocusCurve(curve).best() != 1) continue;
      const Peak p = fit_peak(curve, 1, 0, {});
      EXPECT_EQ(p.shape, PeakShape::parabola);
      EXPECT_NEAR(p.position, peak, 1e-9);
      EXPECT_NEAR(p.score, 5, 1e-9);
      EXPECT_FALSE(p.is_judged());
    }
  }
}

// Far down the slopes three points lie on no parabola: its vertex is off, and sigma must say so.
TEST(FitPeak, AParabolaOfSpreadPointsDoubtsItself) {
  for (const double left : {1.0, 1.7, 2.5}) {
    for (const double right : {1.2, 2.0, 3.9}) {
      const std::vector<double> three = {-left * kWidth, 0, right * kWidth};
      for (const auto shape : {gaussian, lorentzian}) {
        const Curve curve = curve_of(shape, 0.2 * kWidth, three);
        const Peak peak = fit(curve, {1e-4, 4});
        ASSERT_EQ(peak.shape, PeakShape::parabola);
        EXPECT_LT(std::abs(peak.position - 0.2 * kWidth), 3 * peak.sigma) << left << " " << right;
      }
    }
  }
}

TEST(FitPeak, FallsBackToTheEvaluatedPosition) {
  const Peak one = fit(Curve{{1, 5, 1}});
  EXPECT_EQ(one.shape, PeakShape::none);
  EXPECT_EQ(one.position, 5);
  const Peak flat = fit(Curve{{1, 0, 1}, {2, 1, 1}, {3, 2, 1}, {4, 3, 1}, {5, 4, 1}});
  EXPECT_EQ(flat.shape, PeakShape::none);
  EXPECT_GT(flat.sigma, 0);
}

TEST(FitPeak, IsNeverCertain) {
  const Peak exact = fit(curve_of(gaussian, 0, even(4)));
  EXPECT_GT(exact.sigma, 1e-4 * kWidth);
  const Peak noiseless = fit(curve_of(lorentzian, 0, {-4, 0, 4}), {1e-12, 4});
  EXPECT_GT(noiseless.sigma, 1e-4 * kWidth);
}

/// Root of the mean square of (found - true) / sigma over many noisy curves.
double error_in_sigmas(double (*shape)(double), const std::vector<double>& positions, double noise,
                       bool is_known) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  constexpr int kRuns = 400;
  double squares = 0;
  for (int run = 0; run < kRuns; ++run) {
    const double peak = -3 + 6.0 * run / kRuns;
    Curve curve = curve_of(shape, peak, positions);
    for (Evaluation& e : curve) e.score += noise * normal(random);
    // Many degrees of freedom: the noise is known, not itself an estimate from a few frames.
    const Peak found = fit(curve, is_known ? ScoreNoise{noise, 1000} : ScoreNoise{});
    squares += std::pow((found.position - peak) / found.sigma, 2) / kRuns;
  }
  return std::sqrt(squares);
}

TEST(FitPeak, SigmaIsHonestWhereTheNoiseIsKnown) {
  for (const auto shape : {gaussian, lorentzian}) {
    for (const double noise : {0.003, 0.01, 0.03}) {
      for (const auto& positions : {even(3), even(5), kUneven}) {
        const double errors = error_in_sigmas(shape, positions, noise, true);
        EXPECT_GT(errors, 0.6) << noise << " " << positions.size();
        EXPECT_LT(errors, 1.5) << noise << " " << positions.size();
      }
    }
  }
}

TEST(FitPeak, SigmaIsHonestWhereTheNoiseIsNotKnown) {
  for (const auto shape : {gaussian, lorentzian}) {
    for (const double noise : {0.003, 0.01, 0.03}) {
      for (const auto& positions : {even(2), even(3)}) {
        const double errors = error_in_sigmas(shape, positions, noise, false);
        EXPECT_GT(errors, 0.4) << noise << " " << positions.size();
        EXPECT_LT(errors, 1.6) << noise << " " << positions.size();
      }
    }
  }
}

TEST(FitPeak, ScoresMayHaveAnyScale) {
  const Curve curve = curve_of(gaussian, 1.3, kUneven);
  const Peak one = fit(curve, {0.01, 4});
  for (const double scale : {1e-9, 1e9}) {
    Curve scaled = curve;
    for (Evaluation& e : scaled) e.score *= scale;
    const Peak other =
        fit_peak(scaled, FocusCurve(scaled).best(), kFloor * scale, {0.01 * scale, 4});
    EXPECT_NEAR(other.position, one.position, 1e-6);
    EXPECT_NEAR(other.sigma / one.sigma, 1, 1e-6);
  }
}

TEST(FitPeak, AMirroredCurveHasAMirroredPeak) {
  const Curve curve = curve_of(lorentzian, 1.3, kUneven);
  const Peak one = fit(curve, {0.01, 4});
  Curve mirrored(curve.rbegin(), curve.rend());
  for (Evaluation& e : mirrored) e.position = -e.position;
  const Peak other = fit(mirrored, {0.01, 4});
  EXPECT_NEAR(other.position, -one.position, 1e-6);
  EXPECT_NEAR(other.sigma, one.sigma, 1e-6);
}

TEST(FitPeak, AShiftedCurveHasAShiftedPeak) {
  const Curve curve = curve_of(gaussian, 1.3, kUneven);
  const Peak one = fit(curve, {0.01, 4});
  for (const double shift : {-5000.0, 7e6}) {
    Curve shifted = curve;
    for (Evaluation& e : shifted) e.position += shift;
    const Peak other = fit(shifted, {0.01, 4});
    EXPECT_NEAR(other.position - shift, one.position, 1e-6);
    EXPECT_NEAR(other.sigma, one.sigma, 1e-6);
  }
}

TEST(ParsePeakMethod, TakesItsOwnNames) {
  for (const PeakMethod method : {PeakMethod::fit, PeakMethod::evaluated})
    EXPECT_EQ(parse_peak_method(to_string(method)), method);
  EXPECT_ANY_THROW(parse_peak_method("guess"));
}

}  // namespace
}  // namespace fathom
