// SPDX-License-Identifier: Apache-2.0
#include "calibration/fit.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <unsupported/Eigen/NonLinearOptimization>

#include "calibration/outliers.hpp"
#include "engine/error.hpp"
#include "focus/distributions.hpp"

namespace fathom {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorCode::bad_argument, why); }

void require_numbers(CalibrationModel model, std::span<const CalibrationPoint> points) {
  const bool needs_zero = model != CalibrationModel::thin_lens;
  for (const CalibrationPoint& point : points) {
    if (!std::isfinite(point.position) || (needs_zero && !(point.position > 0))) {
      refuse(fmt::format("position {} is none for the {} model, which needs {}", point.position,
                         to_string(model),
                         needs_zero ? "positions above 0; thin-lens takes any" : "a number"));
    }
    if (!(point.distance_mm > 0 && std::isfinite(point.distance_mm))) {
      refuse(fmt::format("a distance of {} mm is not above 0", point.distance_mm));
    }
  }
}

void require_enough(CalibrationModel model, std::span<const CalibrationPoint> points) {
  const auto needed = static_cast<std::size_t>(parameter_count(model));
  if (points.size() < needed) {
    refuse(fmt::format(
        "the {} model has {} parameters, but there {}; measure more distances", to_string(model),
        needed, points.size() == 1 ? "is 1 point" : fmt::format("are {} points", points.size())));
  }
  std::set<double> distances, positions;
  for (const CalibrationPoint& point : points) {
    distances.insert(point.distance_mm);
    positions.insert(point.position);
  }
  if (positions.size() < 2) {
    refuse(
        "all points have the same position, which determines no curve; measure at several "
        "distances");
  }
  if (distances.size() < needed) {
    refuse(
        fmt::format("{} distance{} determine{} no curve of the {} model, which has {} "
                    "parameters; measure more",
                    distances.size(), distances.size() == 1 ? "" : "s",
                    distances.size() == 1 ? "s" : "", to_string(model), needed));
  }
}

[[noreturn]] void refuse_curve(CalibrationModel model) {
  refuse(fmt::format(
      "these points determine no {} curve of distance against position; are their columns right?",
      to_string(model)));
}

CalibrationCurve::Vector to_vector(const Eigen::VectorXd& b) {
  CalibrationCurve::Vector vector = {};
  std::copy(b.begin(), b.end(), vector.begin());
  return vector;
}

/// Position residuals and their Jacobian in units of the curve's position scale, as Eigen's
/// Levenberg-Marquardt asks for them.
class Residuals {
 public:
  Residuals(const CalibrationCurve& curve, std::span<const CalibrationPoint> points)
      : curve_(curve), points_(points) {}

  int inputs() const { return curve_.size(); }
  int values() const { return static_cast<int>(points_.size()); }

  int operator()(const Eigen::VectorXd& b, Eigen::VectorXd& residuals) {
    constexpr double kNoSuchCurve = 1e10;  // So large that the step there is taken back.
    curve_.set(to_vector(b));
    for (int i = 0; i < values(); ++i) {
      const double residual = (points_[i].position - curve_.position_for(points_[i].distance_mm)) /
                              curve_.position_scale();
      residuals(i) = std::abs(residual) < kNoSuchCurve ? residual : kNoSuchCurve;
    }
    return 0;
  }

  int df(const Eigen::VectorXd& b, Eigen::MatrixXd& jacobian) {
    curve_.set(to_vector(b));
    for (int i = 0; i < values(); ++i) {
      const CalibrationCurve::Vector gradient = curve_.gradient(points_[i].distance_mm);
      for (int j = 0; j < inputs(); ++j) jacobian(i, j) = -gradient[j] / curve_.position_scale();
    }
    return 0;
  }

 private:
  CalibrationCurve curve_;
  std::span<const CalibrationPoint> points_;
};

/// Least squares from a start: the curve and the sum of its squares; nothing where there is none.
struct Refined {
  CalibrationCurve::Vector b;
  double squares;
};

std::optional<Refined> refine(const CalibrationCurve& curve,
                              std::span<const CalibrationPoint> points,
                              const CalibrationCurve::Vector& start) {
  Residuals residuals(curve, points);
  Eigen::VectorXd b = Eigen::Map<const Eigen::VectorXd>(start.data(), curve.size());
  if (!b.allFinite()) return std::nullopt;
  Eigen::LevenbergMarquardt<Residuals> optimizer(residuals);
  optimizer.parameters.ftol = optimizer.parameters.xtol = 1e-15;
  optimizer.minimize(b);
  Eigen::VectorXd last(points.size());
  residuals(b, last);
  const double squares = last.squaredNorm();
  constexpr double kNone = 1e19;  // One residual of a curve that does not exist.
  if (!b.allFinite() || !(squares < kNone)) return std::nullopt;
  return Refined{to_vector(b), squares};
}

/// Least squares from the better of two starts: the linear form's and the one given, if any.
CalibrationCurve least_squares(CalibrationCurve curve, std::span<const CalibrationPoint> points,
                               const std::optional<CalibrationCurve::Vector>& start) {
  std::optional<Refined> best;
  const auto linear = linear_start(curve, points);
  for (const auto& from : {linear, start}) {
    const auto refined = from ? refine(curve, points, *from) : std::nullopt;
    // The second must be better beyond rounding, or a fit would not be the same twice.
    if (refined && (!best || refined->squares < best->squares * (1 - 1e-9))) best = refined;
  }
  if (!best) refuse_curve(curve.model());
  curve.set(best->b);
  return curve;
}

/// A lens bends the curve one way, and every curve must lead somewhere.
void require_sense(const CalibrationCurve& curve, std::span<const CalibrationPoint> points) {
  if (curve.model() == CalibrationModel::thin_lens && !(curve.b()[2] > 0)) {
    refuse(
        "these points bend less than any thin lens; measure a wider range of distances, or take "
        "another model");
  }
  for (const CalibrationPoint& point : points) {
    const double slope = curve.slope_mm(curve.position_for(point.distance_mm));
    if (!std::isfinite(slope) || slope == 0) refuse_curve(curve.model());
  }
  for (const auto& parameter : curve.natural()) {
    if (!std::isfinite(parameter.value)) refuse_curve(curve.model());
  }
}

CurveFit describe_fit(const CalibrationCurve& curve, std::span<const CalibrationPoint> points,
                      std::vector<bool> left_out) {
  const auto kept = without(points, left_out);
  const auto n = static_cast<Eigen::Index>(kept.size());
  CurveFit fit{curve, std::move(left_out), static_cast<int>(n) - curve.size(), 0, {}};
  Eigen::MatrixXd jacobian(n, curve.size());
  double squares = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const CalibrationCurve::Vector gradient = curve.gradient(kept[i].distance_mm);
    for (int j = 0; j < curve.size(); ++j) jacobian(i, j) = gradient[j] / curve.position_scale();
    squares += std::pow(kept[i].position - curve.position_for(kept[i].distance_mm), 2);
  }
  if (fit.freedom > 0) fit.scatter = std::sqrt(squares / fit.freedom);
  const Eigen::MatrixXd spread = (jacobian.transpose() * jacobian).inverse();
  for (int i = 0; i < curve.size(); ++i) {
    for (int j = 0; j < curve.size(); ++j)
      fit.spread[i][j] = spread(i, j) / curve.position_scale() / curve.position_scale();
  }
  return fit;
}

CurveFit fit_without(const CalibrationCurve& shape, std::span<const CalibrationPoint> points,
                     std::vector<bool> left_out,
                     const std::optional<CalibrationCurve::Vector>& start) {
  const auto kept = without(points, left_out);
  return describe_fit(least_squares(shape, kept, start), points, std::move(left_out));
}

/// Of the suspects those that the fit without them finds too far off to be one of its points.
std::vector<bool> confirmed(const CurveFit& fit, std::span<const CalibrationPoint> points) {
  constexpr double kFalseAlarm = 0.01;  // Of all points of a clean calibration together.
  const double alarm = kFalseAlarm / static_cast<double>(points.size());
  const double limit = student_t_within(1 - alarm, fit.freedom);
  const double sigma = std::max(fit.scatter, smallest_scatter(points));
  std::vector<bool> outlier = fit.left_out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double off = points[i].position - fit.curve.position_for(points[i].distance_mm);
    const double allowed = limit * sigma * std::sqrt(1 + fit.leverage(points[i].distance_mm));
    if (std::abs(off) <= allowed) outlier[i] = false;
  }
  return outlier;
}

}  // namespace

CurveFit fit_curve(CalibrationModel model, std::span<const CalibrationPoint> points) {
  require_numbers(model, points);
  require_enough(model, points);
  const CalibrationCurve shape(model, points);
  const Suspects suspects = find_suspects(shape, points);
  CurveFit fit = fit_without(shape, points, suspects.outlier, suspects.start);
  if (without(points, fit.left_out).size() < points.size()) {
    std::vector<bool> outlier = confirmed(fit, points);
    if (outlier != fit.left_out) {
      fit = fit_without(shape, points, std::move(outlier), suspects.start);
    }
  }
  require_sense(fit.curve, without(points, fit.left_out));
  return fit;
}

}  // namespace fathom
