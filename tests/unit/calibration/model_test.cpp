// SPDX-License-Identifier: Apache-2.0
// The table of calibration models: whatever stands in it is a model everywhere.
#include "calibration/model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "calibration/choice.hpp"
#include "engine/error.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/unit/calibration/truth.hpp"

namespace fathom {
namespace {

using namespace test;
using Formula = CalibrationFormula;
using Vector = Formula::Vector;

// A model that no file of the library knows: distance = b0 + b1 position. Scaled: u = b0 + b1 t.
constexpr Formula kStraight = {
    .name = "straight",
    .summary = "distance = b0 + b1 position",
    .parameters = 2,
    .ruler = DistanceRuler::distances,
    .takes_any_zero = true,
    .u_at = [](const Vector& b, double t) { return b[0] + b[1] * t; },
    .t_at = [](const Vector& b, double u) { return (u - b[0]) / b[1]; },
    .dt_du = [](const Vector& b, double) { return 1 / b[1]; },
    .du_db =
        [](const Vector&, double t) {
          return Vector{1, t};
        },
    .linear_row =
        [](double t, double u) {
          return Formula::LinearRow{{1, t}, u};
        },
    .from_linear = [](const Vector& x) { return x; },
    .natural =
        [](const Vector& b, const CalibrationScales& s) {
          const double b1 = s.distance_scale / (b[1] * s.position_scale);
          const double at_zero = s.position_origin + b[0] * s.position_scale;
          return std::vector<Formula::Natural>{{"b0",
                                                s.distance_origin - b1 * at_zero,
                                                {-b1 * s.position_scale, b1 * at_zero / b[1]}},
                                               {"b1", b1, {0, -b1 / b[1]}}};
        },
    .equation = [](std::span<const double> b) { return "straight " + std::to_string(b[1]); },
    .objection =
        [](const Vector& b) {
          return b[1] > 0 ? nullptr : "these points fall; take another model";
        }};
constexpr CalibrationModel kModel(kStraight);

std::vector<CalibrationPoint> rising() {
  return points_of([](double mm) { return (mm - 250) / 4; }, 8);
}

TEST(ACalibrationModelOfOneOwn, IsFittedWithoutAnyOtherLine) {
  const auto fit = Calibration::fit(kModel, rising(), {});
  EXPECT_EQ(fit.model(), kModel);
  EXPECT_NEAR(fit.parameters()[0].value, 250, 1e-9);
  EXPECT_NEAR(fit.parameters()[1].value, 4, 1e-12);
  EXPECT_NEAR(fit.distance_mm(400), 1850, 1e-9);
  EXPECT_NEAR(fit.slope_mm(400), 4, 1e-12);
  EXPECT_NEAR(fit.r_squared(), 1, 1e-12);
  EXPECT_EQ(fit.equation(), "straight 4.000000");
}

TEST(ACalibrationModelOfOneOwn, StandsInTheFile) {
  const auto json = nlohmann::json::parse(Calibration::fit(kModel, rising(), {}).json());
  EXPECT_EQ(json.at("model"), "straight");
  EXPECT_NEAR(json.at("parameters").at("b1").get<double>(), 4, 1e-12);
  EXPECT_EQ(json.at("sigmas").size(), 2u);
}

TEST(ACalibrationModelOfOneOwn, RefusesWhatItObjectsTo) {
  auto falling = rising();
  for (auto& point : falling) point.position = -point.position;
  expect_error(ErrorCode::bad_argument, [&] { Calibration::fit(kModel, falling, {}); },
               {"these points fall"});
}

TEST(ACalibrationModelOfOneOwn, IsReadByNameFromATableThatHoldsIt) {
  std::vector<CalibrationModel> table(calibration_models().begin(), calibration_models().end());
  expect_error(ErrorCode::bad_argument, [&] { parse_calibration_model("straight", table); },
               {"\"straight\"", "inverse, power, dioptre and thin-lens"});
  table.push_back(kModel);
  EXPECT_EQ(parse_calibration_model("straight", table), kModel);
  expect_error(ErrorCode::bad_argument, [&] { parse_calibration_model("cubic", table); },
               {"inverse, power, dioptre, thin-lens and straight"});
}

TEST(CalibrationModels, EachHasANameOfItsOwnAndASummary) {
  std::set<std::string> names;
  int last = 0;
  for (const CalibrationModel model : calibration_models()) {
    EXPECT_TRUE(names.insert(to_string(model)).second) << to_string(model);
    EXPECT_STRNE(model.formula().summary, "");
    EXPECT_EQ(parse_calibration_model(to_string(model)), model);
    EXPECT_LE(last, parameter_count(model)) << "those with the fewest parameters come first";
    EXPECT_LE(parameter_count(model), Formula::kMostParameters);
    last = parameter_count(model);
  }
}

TEST(CalibrationModels, AreAllTriedByTheChoice) {
  const ModelChoice choice = choose_calibration_model(points_of(thesis_rig, 8));
  ASSERT_EQ(choice.trials.size(), calibration_models().size());
  for (std::size_t i = 0; i < choice.trials.size(); ++i)
    EXPECT_EQ(choice.trials[i].model, calibration_models()[i]);
}

TEST(CalibrationModels, EachHasATruthInTheTests) {
  for (const CalibrationModel model : calibration_models()) {
    const auto truths = true_models();
    EXPECT_TRUE(std::any_of(truths.begin(), truths.end(),
                            [&](const TrueModel& truth) { return truth.model == model; }))
        << to_string(model) << " needs a line in true_models()";
  }
}

/// Central difference of f at x, good to some 1e-9 of values of order 1.
template <class Function>
double slope(const Function& f, double x) {
  constexpr double kStep = 1e-5;
  return (f(x + kStep) - f(x - kStep)) / (2 * kStep);
}

TEST(CalibrationModels, TheirFunctionsAgreeWithEachOther) {
  std::vector<CalibrationModel> models(calibration_models().begin(), calibration_models().end());
  models.push_back(kModel);
  for (const CalibrationModel model : models) {
    SCOPED_TRACE(to_string(model));
    const Formula& f = model.formula();
    const Vector b = {0.9, 0.7, 0.4};
    for (const double t : {0.0, 0.3, 1.0}) {
      const double u = f.u_at(b, t);
      EXPECT_NEAR(f.t_at(b, u), t, 1e-12);
      EXPECT_NEAR(f.dt_du(b, u), 1 / slope([&](double at) { return f.u_at(b, at); }, t), 1e-7);
      for (std::size_t i = 0; i < static_cast<std::size_t>(f.parameters); ++i) {
        const auto moved = [&](double value) {
          Vector other = b;
          other[i] = value;
          return f.u_at(other, t);
        };
        EXPECT_NEAR(f.du_db(b, t)[i], slope(moved, b[i]), 1e-8) << i;
      }
    }
  }
}

TEST(CalibrationModels, TheLinearFormHoldsOnTheCurve) {
  std::vector<CalibrationModel> models(calibration_models().begin(), calibration_models().end());
  models.push_back(kModel);
  for (const CalibrationModel model : models) {
    SCOPED_TRACE(to_string(model));
    const Formula& f = model.formula();
    const Vector x = {0.9, 0.7, 0.4};
    const Vector b = f.from_linear(x);
    for (const double t : {0.1, 0.6, 1.0}) {
      const auto [row, value] = f.linear_row(t, f.u_at(b, t));
      double sum = 0;
      for (std::size_t i = 0; i < static_cast<std::size_t>(f.parameters); ++i) sum += row[i] * x[i];
      EXPECT_NEAR(sum, value, 1e-12) << t;
    }
  }
}

TEST(CalibrationModels, TheirNaturalParametersChangeAsTheySay) {
  std::vector<CalibrationModel> models(calibration_models().begin(), calibration_models().end());
  models.push_back(kModel);
  const CalibrationScales scales = {
      .distance_origin = 3, .distance_scale = 2, .position_origin = 0, .position_scale = 1.5};
  for (const CalibrationModel model : models) {
    SCOPED_TRACE(to_string(model));
    const Formula& f = model.formula();
    const Vector b = {0.9, 0.7, 0.4};
    const auto natural = f.natural(b, scales);
    EXPECT_EQ(natural.size(), static_cast<std::size_t>(f.parameters));
    for (std::size_t k = 0; k < natural.size(); ++k) {
      for (std::size_t i = 0; i < natural.size(); ++i) {
        const auto moved = [&](double value) {
          Vector other = b;
          other[i] = value;
          return f.natural(other, scales)[k].value;
        };
        EXPECT_NEAR(natural[k].gradient[i], slope(moved, b[i]), 1e-6) << natural[k].name << i;
      }
    }
  }
}

}  // namespace
}  // namespace fathom
