// SPDX-License-Identifier: Apache-2.0
#include "ranging/calibration.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/error.hpp"
#include "engine/file.hpp"

namespace fathom {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kParameters = 2;
constexpr const char* kFormat = "fathom-calibration";
constexpr int kVersion = 1;

void require_usable(CalibrationModel model, const std::vector<CalibrationPoint>& points) {
  if (points.size() < kParameters) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("the {} model has {} parameters, but there {}; measure more distances",
                            to_string(model), kParameters,
                            points.size() == 1 ? "is 1 point"
                                               : fmt::format("are {} points", points.size())));
  }
  for (const CalibrationPoint& point : points) {
    if (!(point.position > 0 && std::isfinite(point.position))) {
      throw Error(
          ErrorCode::bad_argument,
          fmt::format("position {} has no inverse; the inverse model needs positions above 0",
                      point.position));
    }
    if (!(point.distance_mm > 0 && std::isfinite(point.distance_mm))) {
      throw Error(ErrorCode::bad_argument,
                  fmt::format("a distance of {} mm is not above 0", point.distance_mm));
    }
  }
}

/// What few residuals say of a variance is itself uncertain: the variance of Student's t instead of
/// the Gaussian's. It has none below 3 degrees of freedom, so fewer count as 3, which still
/// flatters them.
double small_sample_factor(double freedom) {
  const double enough = std::max(freedom, 3.0);
  return enough / (enough - 2);
}

}  // namespace

const char* to_string(CalibrationModel model) noexcept {
  switch (model) {
    case CalibrationModel::inverse:
      return "inverse";
  }
  return "unknown";
}

CalibrationModel parse_calibration_model(std::string_view name) {
  if (name == "inverse") return CalibrationModel::inverse;
  throw Error(ErrorCode::bad_argument,
              fmt::format("no calibration model \"{}\"; there is inverse", name));
}

Calibration Calibration::fit(CalibrationModel model, std::vector<CalibrationPoint> points,
                             CalibrationConditions conditions) {
  require_usable(model, points);
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd design(n, kParameters);
  Eigen::VectorXd distances(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    design(i, 0) = 1;
    design(i, 1) = 1 / points[i].position;
    distances(i) = points[i].distance_mm;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(design);
  if (solver.rank() < kParameters) {
    throw Error(ErrorCode::bad_argument,
                "all points have the same position, which determines no curve; measure at several "
                "distances");
  }
  const Eigen::VectorXd b = solver.solve(distances);

  Calibration calibration;
  calibration.model_ = model;
  calibration.points_ = std::move(points);
  calibration.conditions_ = std::move(conditions);
  calibration.b0_ = b(0);
  calibration.b1_ = b(1);
  const double residual_squares = (distances - design * b).squaredNorm();
  const double total_squares = (distances.array() - distances.mean()).square().sum();
  calibration.r_squared_ = total_squares > 0 ? 1 - residual_squares / total_squares : 0;

  if (!(std::isfinite(calibration.b0_) && std::isfinite(calibration.b1_) && calibration.b1_ != 0)) {
    throw Error(
        ErrorCode::bad_argument,
        "these points determine no curve of distance against position; are their columns right?");
  }
  const double freedom = static_cast<double>(n - kParameters);
  if (freedom > 0) {
    // The motor's steps scatter alike everywhere; a far distance only shows them larger. So the
    // scatter is taken in steps: a residual divided by the slope there.
    double squares = 0;
    Eigen::VectorXd variances(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const CalibrationPoint& point = calibration.points_[i];
      const double slope = calibration.slope_mm(point.position);
      const double residual = (point.distance_mm - calibration.distance_mm(point.position)) / slope;
      squares += residual * residual;
      variances(i) = slope * slope;
    }
    const double scatter_squared = squares / freedom * small_sample_factor(freedom);
    calibration.position_scatter_ = std::sqrt(scatter_squared);
    // b = (X'X)^-1 X' y with y of unequal variances: the sandwich (X'X)^-1 X' V X (X'X)^-1.
    const Eigen::Matrix2d bread = (design.transpose() * design).inverse();
    const Eigen::Matrix2d covariance =
        bread * design.transpose() * (scatter_squared * variances).asDiagonal() * design * bread;
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) calibration.covariance_[i][j] = covariance(i, j);
    }
  }
  return calibration;
}

std::vector<double> Calibration::residuals_mm() const {
  std::vector<double> residuals;
  for (const CalibrationPoint& point : points_) {
    residuals.push_back(point.distance_mm - distance_mm(point.position));
  }
  return residuals;
}

double Calibration::distance_mm(double position) const { return b0_ + b1_ / position; }

double Calibration::slope_mm(double position) const { return -b1_ / (position * position); }

double Calibration::fit_variance_mm2(double position) const {
  const double x = 1 / position;
  return covariance_[0][0] + 2 * x * covariance_[0][1] + x * x * covariance_[1][1];
}

Distance Calibration::distance(double position, double position_sigma) const {
  const double from_position = slope_mm(position) * position_sigma;
  return {distance_mm(position),
          std::sqrt(from_position * from_position + std::max(0.0, fit_variance_mm2(position)))};
}

namespace {

/// How far beyond the outermost points a position may lie and still be one of theirs.
double margin(const Calibration& calibration, double lowest, double highest) {
  constexpr double kShareOfSpan = 0.01;
  return std::max(3 * calibration.position_scatter(), kShareOfSpan * (highest - lowest));
}

std::pair<double, double> span_of(const std::vector<CalibrationPoint>& points) {
  const auto [first, last] = std::minmax_element(
      points.begin(), points.end(),
      [](const CalibrationPoint& a, const CalibrationPoint& b) { return a.position < b.position; });
  return {first->position, last->position};
}

}  // namespace

double Calibration::lowest_position() const {
  const auto [lowest, highest] = span_of(points_);
  return lowest - margin(*this, lowest, highest);
}

double Calibration::highest_position() const {
  const auto [lowest, highest] = span_of(points_);
  return highest + margin(*this, lowest, highest);
}

bool Calibration::covers(double position) const {
  return position >= lowest_position() && position <= highest_position();
}

std::string Calibration::json() const {
  Json points = Json::array();
  const auto residuals = residuals_mm();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    points.push_back({{"position", points_[i].position},
                      {"distance_mm", points_[i].distance_mm},
                      {"residual_mm", residuals[i]}});
  }
  const Json json = {{"format", kFormat},
                     {"version", kVersion},
                     {"model", to_string(model_)},
                     {"b0", b0_},
                     {"b1", b1_},
                     {"r_squared", r_squared_},
                     {"position_scatter", position_scatter_},
                     {"conditions",
                      {{"rig", conditions_.rig},
                       {"metric", conditions_.metric},
                       {"window_side", conditions_.window_side},
                       {"unit", conditions_.unit}}},
                     {"points", points}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Calibration Calibration::parse(std::string_view text, std::string_view name) {
  try {
    const Json json = Json::parse(text);
    if (json.at("format") != kFormat || json.at("version") != kVersion) {
      throw Error(ErrorCode::bad_data,
                  fmt::format("{} is no calibration of version {}; make one with fathom calibrate",
                              name, kVersion));
    }
    std::vector<CalibrationPoint> points;
    for (const Json& point : json.at("points")) {
      points.push_back({point.at("position"), point.at("distance_mm")});
    }
    const Json& made = json.at("conditions");
    return fit(parse_calibration_model(json.at("model").get<std::string>()), std::move(points),
               {made.at("rig"), made.at("metric"), made.at("window_side"), made.at("unit")});
  } catch (const Json::exception&) {
    throw Error(
        ErrorCode::bad_data,
        fmt::format("{} is damaged or no calibration; make one with fathom calibrate", name));
  } catch (const Error& error) {
    if (error.code() == ErrorCode::bad_data) throw;
    throw Error(ErrorCode::bad_data, fmt::format("{}: {}", name, error.what()));
  }
}

}  // namespace fathom
