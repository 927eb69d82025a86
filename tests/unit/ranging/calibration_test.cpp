// SPDX-License-Identifier: Apache-2.0
#include "ranging/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/error.hpp"

namespace fathom {
namespace {

const CalibrationConditions kConditions{"test rig", "fft:64:hann", 64, "steps"};

/// The thesis rig: distance = f + f^2/e with an extension that grows by steps.
double thin_lens_distance(double position) { return 135 + 1.3008e6 / position; }

std::vector<CalibrationPoint> points_with_scatter(double scatter_steps, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> error(0, scatter_steps);
  std::vector<CalibrationPoint> points;
  for (int i = 0; i < count; ++i) {
    const double position = 527 + (1028.0 - 527) * i / (count - 1);
    points.push_back(
        {position + (scatter_steps > 0 ? error(random) : 0), thin_lens_distance(position)});
  }
  return points;
}

TEST(Calibration, RecoversAnExactCurve) {
  const auto fit =
      Calibration::fit(CalibrationModel::inverse, points_with_scatter(0, 8, 1), kConditions);
  EXPECT_NEAR(fit.b0(), 135, 1e-6);
  EXPECT_NEAR(fit.b1(), 1.3008e6, 1e-2);
  EXPECT_NEAR(fit.r_squared(), 1, 1e-12);
  for (const double residual : fit.residuals_mm()) EXPECT_NEAR(residual, 0, 1e-6);
  EXPECT_NEAR(fit.distance_mm(800), thin_lens_distance(800), 1e-6);
}

// Ordinary least squares of y on 1/x, worked out by the normal equations with plain sums.
TEST(Calibration, IsOrdinaryLeastSquaresInDistance) {
  const auto points = points_with_scatter(3, 12, 7);
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  for (const auto& p : points) {
    const double x = 1 / p.position, y = p.distance_mm;
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y, syy += y * y;
  }
  const double b1 = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  const double b0 = (sy - b1 * sx) / n;
  double residual_squares = 0;
  for (const auto& p : points)
    residual_squares += std::pow(p.distance_mm - b0 - b1 / p.position, 2);
  const auto fit = Calibration::fit(CalibrationModel::inverse, points, kConditions);
  EXPECT_NEAR(fit.b0() / b0, 1, 1e-8);
  EXPECT_NEAR(fit.b1() / b1, 1, 1e-8);
  EXPECT_NEAR(fit.r_squared(), 1 - residual_squares / (syy - sy * sy / n), 1e-10);
  EXPECT_LT(fit.r_squared(), 1);
}

TEST(Calibration, LearnsTheScatterOfAPosition) {
  const auto fit =
      Calibration::fit(CalibrationModel::inverse, points_with_scatter(2, 400, 3), kConditions);
  EXPECT_NEAR(fit.position_scatter(), 2, 0.2);
}

// An honest sigma: over many calibrations, errors divided by their sigma scatter by 1.
TEST(Calibration, SigmaIsHonest) {
  std::mt19937 random(17);
  std::normal_distribution<double> error(0, 2);
  std::uniform_real_distribution<double> anywhere(540, 1010);
  double squares = 0;
  constexpr int trials = 2000;
  for (int i = 0; i < trials; ++i) {
    const auto fit =
        Calibration::fit(CalibrationModel::inverse,
                         points_with_scatter(2, 30, static_cast<unsigned>(i)), kConditions);
    const double truth = anywhere(random);
    const Distance d = fit.distance(truth + error(random), fit.position_scatter());
    squares += std::pow((d.mm - thin_lens_distance(truth)) / d.sigma_mm, 2);
  }
  EXPECT_NEAR(std::sqrt(squares / trials), 1, 0.1);
}

TEST(Calibration, KnowsWhatItCovers) {
  const auto fit =
      Calibration::fit(CalibrationModel::inverse, points_with_scatter(0, 8, 1), kConditions);
  EXPECT_TRUE(fit.covers(527));
  EXPECT_TRUE(fit.covers(1028));
  EXPECT_TRUE(fit.covers(524));
  EXPECT_FALSE(fit.covers(500));
  EXPECT_FALSE(fit.covers(1060));
  EXPECT_FALSE(fit.covers(std::nan("")));
}

TEST(Calibration, RefusesWhatDeterminesNoCurve) {
  const auto fit = [](std::vector<CalibrationPoint> points) {
    return Calibration::fit(CalibrationModel::inverse, std::move(points), kConditions);
  };
  EXPECT_THROW(fit({}), Error);
  EXPECT_THROW(fit({{700, 1800}}), Error);
  EXPECT_THROW(fit({{700, 1800}, {700, 1900}, {700, 1850}}), Error);
  EXPECT_THROW(fit({{0, 1800}, {700, 1900}}), Error);
  EXPECT_THROW(fit({{-5, 1800}, {700, 1900}}), Error);
  EXPECT_THROW(fit({{600, 0}, {700, 1900}}), Error);
  EXPECT_THROW(fit({{600, std::nan("")}, {700, 1900}}), Error);
  EXPECT_THROW(fit({{std::numeric_limits<double>::infinity(), 1800}, {700, 1900}}), Error);
  EXPECT_NO_THROW(fit({{600, 2300}, {700, 1990}}));
}

TEST(Calibration, JsonRoundTripsToTheSameCurve) {
  const auto fit =
      Calibration::fit(CalibrationModel::inverse, points_with_scatter(2, 9, 5), kConditions);
  const auto again = Calibration::parse(fit.json(), "cal.json");
  EXPECT_EQ(again.b0(), fit.b0());
  EXPECT_EQ(again.b1(), fit.b1());
  EXPECT_EQ(again.r_squared(), fit.r_squared());
  EXPECT_EQ(again.conditions(), fit.conditions());
  EXPECT_EQ(again.json(), fit.json());
}

TEST(Calibration, RefusesOtherFiles) {
  for (const char* text :
       {"", "{", "[]", "{}", "null", R"({"format":"fathom-record","version":1})",
        R"({"format":"fathom-calibration","version":2})",
        R"({"format":"fathom-calibration","version":1,"model":"inverse","points":7})"}) {
    try {
      Calibration::parse(text, "cal.json");
      ADD_FAILURE() << "took " << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_data) << text;
      EXPECT_NE(std::string(error.what()).find("cal.json"), std::string::npos) << error.what();
    }
  }
}

TEST(CalibrationPoints, ReadsColumnsByName) {
  const auto points = parse_calibration_points(
      "# by hand\nnote,distance_mm,position\na,1400,1028\n\nb, 2600 ,\"527\"\r\n", "points.csv");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].position, 1028);
  EXPECT_EQ(points[0].distance_mm, 1400);
  EXPECT_EQ(points[1].position, 527);
  EXPECT_EQ(points[1].distance_mm, 2600);
}

TEST(CalibrationPoints, NamesTheBadLine) {
  for (const char* text : {"position,distance\n1,2\n", "position,distance_mm\n1,2\n3,far\n",
                           "position,distance_mm\n1\n", "1,2\n3,4\n"}) {
    try {
      parse_calibration_points(text, "points.csv");
      ADD_FAILURE() << "took " << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("points.csv line"), std::string::npos)
          << error.what();
    }
  }
}

TEST(CalibrationModel, ListsTheChoices) {
  EXPECT_EQ(parse_calibration_model("inverse"), CalibrationModel::inverse);
  EXPECT_THROW(parse_calibration_model("cubic"), Error);
}

}  // namespace
}  // namespace fathom
