// SPDX-License-Identifier: Apache-2.0
#include "calibration/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/error.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/unit/calibration/truth.hpp"

namespace fathom {
namespace {

using namespace test;

const CalibrationConditions kConditions{"test rig", "fft:64:hann", {96, 88, 64}, "steps"};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Calibration, RecoversAnExactCurve) {
  for (const auto& [model, truth, parameters] : true_models()) {
    const auto fit = Calibration::fit(model, points_of(truth, 8), kConditions);
    ASSERT_EQ(fit.parameters().size(), parameters.size());
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      EXPECT_NEAR(fit.parameters()[i].value / parameters[i], 1, 1e-9) << fit.parameters()[i].name;
    }
    EXPECT_NEAR(fit.r_squared(), 1, 1e-12);
    EXPECT_EQ(count_left_out(fit), 0);
    for (const double residual : fit.residuals_mm()) EXPECT_NEAR(residual, 0, 1e-8);
  }
}

TEST(Calibration, ConvertsBothWays) {
  for (const auto& [model, truth, parameters] : true_models()) {
    const auto fit = Calibration::fit(model, points_of(truth, 8), kConditions);
    for (const double distance : {1000.0, 1400.0, 1900.0, 2600.0, 5000.0}) {
      EXPECT_NEAR(fit.position_for(distance), truth(distance), 1e-6) << to_string(model);
      EXPECT_NEAR(fit.distance_mm(truth(distance)), distance, 1e-5) << to_string(model);
      constexpr double h = 1e-3;
      const double slope =
          (fit.distance_mm(truth(distance) + h) - fit.distance_mm(truth(distance) - h)) / (2 * h);
      EXPECT_NEAR(fit.slope_mm(truth(distance)) / slope, 1, 1e-6) << to_string(model);
    }
  }
}

TEST(Calibration, KnowsWhereInfinityLies) {
  const auto inverse =
      Calibration::fit(CalibrationModel::inverse, points_of(thesis_rig, 8), kConditions);
  EXPECT_EQ(inverse.distance_mm(0), kInfinity);
  EXPECT_EQ(inverse.distance_mm(-5), kInfinity);
  EXPECT_TRUE(std::isnan(inverse.position_for(100)));  // Nearer than the focal length.
  const auto offset =
      Calibration::fit(CalibrationModel::thin_lens, points_of(offset_rig, 8), kConditions);
  EXPECT_EQ(offset.distance_mm(299), kInfinity);
  EXPECT_GT(offset.distance_mm(301), 1e6);
  EXPECT_TRUE(std::isnan(offset.position_for(100)));
  const auto reversed =
      Calibration::fit(CalibrationModel::thin_lens, points_of(reversed_rig, 8), kConditions);
  EXPECT_EQ(reversed.distance_mm(2001), kInfinity);
  EXPECT_GT(reversed.distance_mm(1999), 1e6);
  EXPECT_TRUE(std::isnan(offset.distance_mm(std::nan(""))));
}

/// Sum of squared position residuals for the best curve with this one non-linear parameter: focal
/// length (inverse, thin lens) or exponent (power), by plain regression in the others.
double profile(CalibrationModel model, double shape, const std::vector<CalibrationPoint>& points) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& p : points) {
    const double x = model == CalibrationModel::power ? std::pow(p.distance_mm / 2000, 1 / shape)
                                                      : 1000 / (p.distance_mm - shape);
    n += 1, sx += x, sy += p.position, sxx += x * x, sxy += x * p.position;
  }
  const bool with_offset = model == CalibrationModel::thin_lens;
  const double slope = with_offset ? (n * sxy - sx * sy) / (n * sxx - sx * sx) : sxy / sxx;
  const double offset = with_offset ? (sy - slope * sx) / n : 0;
  double squares = 0;
  for (const auto& p : points) {
    const double x = model == CalibrationModel::power ? std::pow(p.distance_mm / 2000, 1 / shape)
                                                      : 1000 / (p.distance_mm - shape);
    squares += std::pow(p.position - offset - slope * x, 2);
  }
  return squares;
}

/// Where the profile is least, by golden section.
double best_shape(CalibrationModel model, double a, double b,
                  const std::vector<CalibrationPoint>& points) {
  constexpr double kGolden = 0.6180339887498949;
  while (std::abs(b - a) > 1e-9 * (std::abs(a) + std::abs(b))) {
    const double c = b - kGolden * (b - a), d = a + kGolden * (b - a);
    if (profile(model, c, points) < profile(model, d, points)) {
      b = d;
    } else {
      a = c;
    }
  }
  return (a + b) / 2;
}

// The oracle: with one parameter fixed the others are a regression by plain sums; then a search.
TEST(Calibration, IsLeastSquaresInPosition) {
  struct Case {
    CalibrationModel model;
    Truth truth;
    double from, to;
    std::size_t shape;  ///< Which parameter the search is over.
  };
  for (const auto& [model, truth, from, to, shape] :
       {Case{CalibrationModel::inverse, thesis_rig, -500, 1000, 0},
        Case{CalibrationModel::power, power_rig, -2, -0.5, 1},
        Case{CalibrationModel::power, rising_power_rig, 0.5, 2, 1},
        Case{CalibrationModel::thin_lens, offset_rig, -500, 1000, 0},
        Case{CalibrationModel::thin_lens, reversed_rig, -500, 1000, 0}}) {
    const auto points = points_of(truth, 12, 3, 7);
    const auto fit = Calibration::fit(model, points, kConditions);
    ASSERT_EQ(count_left_out(fit), 0);
    const double best = best_shape(model, from, to, points);
    double squares = 0;
    for (const double residual : fit.position_residuals()) squares += residual * residual;
    EXPECT_NEAR(squares / profile(model, best, points), 1, 1e-9) << to_string(model);
    // A search for a minimum finds its place to the root of the precision of its value.
    EXPECT_NEAR(fit.parameters()[shape].value / best, 1, 1e-4) << to_string(model);
  }
}

TEST(Calibration, RSquaredIsThatOfTheDistances) {
  const auto points = points_of(thesis_rig, 12, 3, 7);
  const auto fit = Calibration::fit(CalibrationModel::inverse, points, kConditions);
  double residual_squares = 0, total_squares = 0;
  for (const auto& p : points) {
    residual_squares += std::pow(p.distance_mm - fit.distance_mm(p.position), 2);
    total_squares += std::pow(p.distance_mm - 2000, 2);
  }
  EXPECT_NEAR(fit.r_squared(), 1 - residual_squares / total_squares, 1e-12);
  EXPECT_LT(fit.r_squared(), 1);
}

TEST(Calibration, KnowsWhatItCovers) {
  const auto fit =
      Calibration::fit(CalibrationModel::inverse, points_of(thesis_rig, 8), kConditions);
  EXPECT_TRUE(fit.covers(528));
  EXPECT_TRUE(fit.covers(1028));
  EXPECT_TRUE(fit.covers(524));
  EXPECT_FALSE(fit.covers(500));
  EXPECT_FALSE(fit.covers(1060));
  EXPECT_FALSE(fit.covers(std::nan("")));
}

TEST(Calibration, RefusesWhatDeterminesNoCurve) {
  for (const auto model : calibration_models()) {
    const auto refuses = [&](std::vector<CalibrationPoint> points, const char* why) {
      try {
        Calibration::fit(model, std::move(points), kConditions);
        return ADD_FAILURE() << to_string(model) << " took " << why, void();
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::bad_argument);
      }
    };
    refuses({}, "nothing");
    refuses({{700, 1800}}, "one point");
    refuses({{700, 1800}, {700, 1900}, {700, 1850}}, "one position");
    refuses({{700, 1800}, {710, 1800}, {720, 1800}}, "one distance");
    refuses({{600, 0}, {700, 1900}, {800, 1700}}, "no distance");
    refuses({{600, -5}, {700, 1900}, {800, 1700}}, "a distance behind the lens");
    refuses({{600, std::nan("")}, {700, 1900}, {800, 1700}}, "NaN");
    refuses({{std::nan(""), 2000}, {700, 1900}, {800, 1700}}, "a NaN position");
    refuses({{kInfinity, 1800}, {700, 1900}, {800, 1700}}, "infinity");
    if (model == CalibrationModel::thin_lens) {
      refuses({{600, 2300}, {700, 1990}}, "two points for three parameters");
      refuses({{600, 2300}, {700, 1990}, {701, 1990}}, "two distances for three parameters");
      refuses({{1400, 1400}, {1000, 2000}, {400, 2600}}, "a curve bent the other way");
    } else {
      if (!model.formula().takes_any_zero) {
        refuses({{0, 1800}, {700, 1900}}, "position 0");
        refuses({{-5, 1800}, {700, 1900}}, "a negative position");
      }
      EXPECT_NO_THROW(Calibration::fit(model, {{600, 2300}, {700, 1990}}, {}));
    }
  }
}

TEST(Calibration, AThinLensTakesAnyPosition) {
  const auto fit = Calibration::fit(CalibrationModel::thin_lens,
                                    points_of([](double d) { return thesis_rig(d) - 700; }, 6), {});
  EXPECT_NEAR(fit.parameters()[1].value, -700, 1e-6);
  EXPECT_NEAR(fit.distance_mm(0), 135 + 1.3008e6 / 700, 1e-6);
}

TEST(Calibration, TheUnitOfPositionsDoesNotMatter) {
  for (const double unit : {1e-6, 1e6}) {
    for (const auto& [model, truth, parameters] : true_models()) {
      auto points = points_of(truth, 9, 1.5, 4);
      const auto steps = Calibration::fit(model, points, {});
      for (auto& point : points) point.position *= unit;
      const auto other = Calibration::fit(model, points, {});
      EXPECT_NEAR(other.distance_mm(truth(1900) * unit) / steps.distance_mm(truth(1900)), 1, 1e-9);
      EXPECT_NEAR(other.position_scatter() / unit / steps.position_scatter(), 1, 1e-6);
    }
  }
}

TEST(Calibration, JsonRoundTripsToTheSameCurve) {
  for (const auto& [model, truth, parameters] : true_models()) {
    auto points = points_of(truth, 9, 2, 5);
    points[3].position += 60;
    const auto fit = Calibration::fit(model, points, kConditions);
    EXPECT_TRUE(fit.left_out(3));
    const auto again = Calibration::parse(fit.json(), "cal.json");
    EXPECT_EQ(again.model(), model);
    EXPECT_EQ(again.conditions(), fit.conditions());
    EXPECT_EQ(again.json(), fit.json());
  }
}

TEST(Calibration, KeepsTheBlurOfTheLens) {
  const auto [model, truth, parameters] = true_models().front();
  CalibrationConditions conditions = kConditions;
  conditions.blur =
      BlurModel{.px_per_unit = 0.08, .uncertainty = 0.04, .shape = BlurShape::gaussian};
  const auto fit = Calibration::fit(model, points_of(truth, 9, 2, 5), conditions);
  EXPECT_EQ(Calibration::parse(fit.json(), "cal.json").conditions(), conditions);
  EXPECT_EQ(Calibration::fit(model, points_of(truth, 9, 2, 5), kConditions).json().find("blur"),
            std::string::npos)
      << "what nobody knows is left out";
  std::string damaged = fit.json();
  damaged.replace(damaged.find("gaussian"), 8, "triangle");
  expect_error(ErrorCode::bad_data, [&] { Calibration::parse(damaged, "cal.json"); }, {"cal.json"});
}

constexpr const char* kVersion1 = R"({"format":"fathom-calibration","version":1,"model":"inverse",
  "b0":7,"conditions":{"rig":"r","metric":"fft:64:hann","window_side":64,"unit":"steps"},
  "points":[{"position":1028,"distance_mm":1400},{"position":731,"distance_mm":1914},
            {"position":527,"distance_mm":2600}]})";

TEST(Calibration, ReadsVersion1WithoutThePlaceOfItsWindow) {
  const auto fit = Calibration::parse(kVersion1, "old.json");
  EXPECT_EQ(fit.conditions().window.n, 64);
  EXPECT_EQ(fit.conditions().window.x, CalibrationConditions::kUnknown);
  EXPECT_EQ(fit.points().size(), 3u);
  EXPECT_NEAR(fit.distance_mm(731), 1914, 5) << "fitted from its points, not read from b0";
  EXPECT_EQ(Calibration::parse(fit.json(), "new.json").conditions(), fit.conditions());
}

TEST(Calibration, NamesAVersionThatItDoesNotRead) {
  for (const char* version : {"3", "0", "\"2\"", "2.5", "null"}) {
    std::string text = kVersion1;
    text.replace(text.find("\"version\":1") + 10, 1, version);
    try {
      Calibration::parse(text, "cal.json");
      ADD_FAILURE() << "took version " << version;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_data);
      const std::string what = error.what();
      EXPECT_NE(what.find("cal.json"), std::string::npos) << what;
      EXPECT_NE(what.find(std::string("version ") + version), std::string::npos) << what;
      EXPECT_NE(what.find("calibrate again"), std::string::npos) << what;
    }
  }
}

TEST(Calibration, RefusesOtherFiles) {
  for (const char* text :
       {"", "{", "[]", "{}", "null", R"({"format":"fathom-record","version":1})",
        R"({"format":"fathom-calibration","version":2})",
        R"({"format":"fathom-calibration","version":2,"model":"cubic","points":[],"conditions":
           {"rig":"","metric":"","window":[0,0,8],"unit":""}})",
        R"({"format":"fathom-calibration","version":1,"model":"inverse","points":7})",
        R"({"format":"fathom-calibration","version":1,"model":"inverse","points":
           [{"position":1,"distance_mm":2},{"position":2,"distance_mm":1}],"conditions":
           {"rig":"","metric":"","window_side":7.7e37,"unit":""}})"}) {
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
      "# by hand\nnote,distance_mm,position\na,1400,1028\n\nb, 2600 ,\"-27.5\"\r\n", "points.csv");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].position, 1028);
  EXPECT_EQ(points[0].distance_mm, 1400);
  EXPECT_EQ(points[1].position, -27.5);
  EXPECT_EQ(points[1].distance_mm, 2600);
}

TEST(CalibrationPoints, NamesTheBadLine) {
  for (const char* text : {"position,distance\n1,2\n", "position,distance_mm\n1,2\n3,far\n",
                           "position,distance_mm\n1\n", "1,2\n3,4\n", "position,distance_mm\n1,0\n",
                           "position,distance_mm\nnan,2\n", "position,distance_mm\n1,-2\n"}) {
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
  for (const auto model : calibration_models()) {
    EXPECT_EQ(parse_calibration_model(to_string(model)), model);
  }
  EXPECT_THROW(parse_calibration_model("cubic"), Error);
}

}  // namespace
}  // namespace fathom
