// SPDX-License-Identifier: Apache-2.0
#include "calibration/choice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "engine/error.hpp"
#include "tests/unit/calibration/truth.hpp"

namespace fathom {
namespace {

using namespace test;

TEST(ModelChoice, TakesTheModelThatTheDataHave) {
  for (const auto& [model, truth, parameters] : true_models()) {
    int right = 0;
    for (unsigned seed = 0; seed < 50; ++seed) {
      right += choose_calibration_model(points_of(truth, 10, 0.5, seed)).model == model ? 1 : 0;
    }
    EXPECT_GE(right, 40) << to_string(model);
  }
}

TEST(ModelChoice, TakesTheModelOfExactData) {
  for (const auto& [model, truth, parameters] : true_models()) {
    const ModelChoice choice = choose_calibration_model(points_of(truth, 8));
    EXPECT_EQ(choice.model, model) << to_string(choice.best);
    EXPECT_EQ(choice.trials.size(), calibration_models().size());
  }
}

TEST(ModelChoice, AnOutlierDoesNotDecide) {
  for (const auto& [model, truth, parameters] : true_models()) {
    int right = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
      auto points = points_of(truth, 12, 0.5, seed);
      points[seed % 12].position += 80;
      right += choose_calibration_model(points).model == model ? 1 : 0;
    }
    EXPECT_GE(right, 15) << to_string(model);
  }
}

// By hand: of three points without scatter each is predicted exactly by the inverse curve through
// the other two; the power curve misses the middle one by what its own two-point formula says.
TEST(ModelChoice, TheErrorIsThatOfPredictingWhatWasLeftOut) {
  const auto points = points_of(thesis_rig, 3);
  const ModelChoice choice = choose_calibration_model(points);
  EXPECT_LT(choice.trials[0].error, 1e-9);
  double squares = 0;
  for (std::size_t out = 0; out < 3; ++out) {
    const auto& a = points[(out + 1) % 3];
    const auto& b = points[(out + 2) % 3];
    const double b1 = std::log(a.distance_mm / b.distance_mm) / std::log(a.position / b.position);
    const double predicted = a.distance_mm * std::pow(points[out].position / a.position, b1);
    squares += std::pow(predicted / points[out].distance_mm - 1, 2) / 3;
  }
  EXPECT_NEAR(choice.trials[1].error, std::sqrt(squares), 1e-9);
  EXPECT_TRUE(std::isinf(choice.trials.back().error));
  EXPECT_NE(choice.trials.back().problem, "");
  EXPECT_EQ(choice.model, CalibrationModel::inverse);
}

TEST(ModelChoice, RepeatsOfADistanceLeaveTogether) {
  // Two points at each of three distances: a point's twin must not help to predict it, so a thin
  // lens, which needs three distances, predicts nothing.
  auto points = points_of(thesis_rig, 3, 1, 1);
  for (const auto& point : points_of(thesis_rig, 3, 1, 2)) points.push_back(point);
  EXPECT_TRUE(std::isinf(choose_calibration_model(points).trials.back().error));
}

TEST(ModelChoice, PositionsBelowZeroLeaveModelsWhoseZeroMeansNothing) {
  const auto choice =
      choose_calibration_model(points_of([](double d) { return thesis_rig(d) - 700; }, 8, 0.5));
  EXPECT_EQ(choice.model, CalibrationModel::thin_lens);
  EXPECT_TRUE(std::isinf(choice.trials[0].error));
  EXPECT_TRUE(std::isnan(choice.trials[0].r_squared));
}

// A webcam from 100 mm to a metre: positions of 0.04 dioptres, scattered by half of one.
TEST(ModelChoice, ALensOfDioptresIsTakenForOne) {
  int right = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> error(0, 0.5);
    std::vector<CalibrationPoint> points;
    for (const double mm :
         {100., 120., 150., 180., 220., 260., 320., 400., 500., 650., 800., 1000.})
      points.push_back({(1000 / mm + 0.5) / 0.04 + error(random), mm});
    const auto choice = choose_calibration_model(points);
    right += choice.model == CalibrationModel::dioptre ? 1 : 0;
    const auto fit = Calibration::fit(CalibrationModel::dioptre, points, {});
    EXPECT_NEAR(fit.parameters()[1].value, 0.04, 0.0008);
    EXPECT_TRUE(std::isinf(fit.distance_mm(0)));  // beyond its focus on infinity
    EXPECT_NE(fit.equation().find("1000 mm / ("), std::string::npos) << fit.equation();
  }
  std::cout << "dioptre: chosen in " << right << " of 50\n";
  EXPECT_GE(right, 40);
}

TEST(ModelChoice, ManyDistancesTakeReasonableTime) {
  const auto choice = choose_calibration_model(points_of(offset_rig, 400, 2));
  EXPECT_EQ(choice.model, CalibrationModel::thin_lens);
}

TEST(ModelChoice, RefusesWhatItCannotJudge) {
  EXPECT_THROW(choose_calibration_model({}), Error);
  EXPECT_THROW(choose_calibration_model(points_of(thesis_rig, 2)), Error);
  EXPECT_THROW(choose_calibration_model(std::vector<CalibrationPoint>(
                   {{std::nan(""), 1400}, {700, 1800}, {650, 2000}, {600, 2200}})),
               Error);
  EXPECT_THROW(choose_calibration_model(std::vector<CalibrationPoint>(
                   {{1000, std::nan("")}, {700, 1800}, {650, 2000}, {600, 2200}})),
               Error);
}

}  // namespace
}  // namespace fathom
