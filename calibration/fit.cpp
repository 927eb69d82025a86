// SPDX-License-Identifier: Apache-2.0
#include "calibration/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "calibration/outliers.hpp"
#include "engine/error.hpp"
#include "focus/distributions.hpp"
#include "focus/least_squares.hpp"

namespace fathom {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorCode::bad_argument, why); }

/// The models whose positions may count from anywhere.
std::string names_of_any_zero() {
  std::string names;
  for (const CalibrationModel model : calibration_models()) {
    if (!model.formula().takes_any_zero) continue;
    names += (names.empty() ? "" : " or ") + std::string(to_string(model));
  }
  return names;
}

void require_numbers(CalibrationModel model, std::span<const CalibrationPoint> points) {
  const bool needs_zero = !model.formula().takes_any_zero;
  for (const CalibrationPoint& point : points) {
    if (!std::isfinite(point.position) || (needs_zero && !(point.position > 0))) {
      refuse(fmt::format(
          "position {} is none for the {} model, which needs {}", point.position, to_string(model),
          needs_zero ? fmt::format("positions above 0; {} takes any", names_of_any_zero())
                     : "a number"));
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

CalibrationCurve with(CalibrationCurve curve, std::span<const double> b) {
  CalibrationCurve::Vector vector = {};
  std::copy(b.begin(), b.end(), vector.begin());
  curve.set(vector);
  return curve;
}

/// Position residuals and their derivatives, in units of the curve's position scale.
ResidualModel residual_model(const CalibrationCurve& shape,
                             std::span<const CalibrationPoint> points) {
  const double scale = shape.position_scale();
  const auto residuals = [=](std::span<const double> b, std::span<double> all) {
    constexpr double kNoSuchCurve = 1e10;  // So large that the step there is taken back.
    const CalibrationCurve curve = with(shape, b);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double residual =
          (points[i].position - curve.position_for(points[i].distance_mm)) / scale;
      all[i] = std::abs(residual) < kNoSuchCurve ? residual : kNoSuchCurve;
    }
  };
  const auto jacobian = [=](std::span<const double> b, Matrix& all) {
    const CalibrationCurve curve = with(shape, b);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const CalibrationCurve::Vector gradient = curve.gradient(points[i].distance_mm);
      for (std::size_t j = 0; j < b.size(); ++j) all(i, j) = -gradient[j] / scale;
    }
  };
  return {points.size(), residuals, jacobian};
}

/// Least squares from a start: the curve and the sum of its squares; nothing where there is none.
struct Refined {
  CalibrationCurve curve;
  double squares;
};

bool all_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

std::optional<Refined> refine(const CalibrationCurve& shape,
                              std::span<const CalibrationPoint> points,
                              const CalibrationCurve::Vector& start) {
  const std::span<const double> used(start.data(), static_cast<std::size_t>(shape.size()));
  if (!all_finite(used)) return std::nullopt;
  const ResidualModel model = residual_model(shape, points);
  constexpr double kTolerance = 1e-15;
  const auto b = minimize_squares(model, {used.begin(), used.end()}, kTolerance);
  std::vector<double> residuals(points.size());
  model.residuals(b, residuals);
  double squares = 0;
  for (const double residual : residuals) squares += residual * residual;
  constexpr double kNone = 1e19;  // One residual of a curve that does not exist.
  if (!all_finite(b) || !(squares < kNone)) return std::nullopt;
  return Refined{with(shape, b), squares};
}

/// Least squares from the better of two starts: the linear form's and the one given, if any.
CalibrationCurve least_squares(const CalibrationCurve& curve,
                               std::span<const CalibrationPoint> points,
                               const std::optional<CalibrationCurve::Vector>& start) {
  std::optional<Refined> best;
  const auto linear = linear_start(curve, points);
  for (const auto& from : {linear, start}) {
    const auto refined = from ? refine(curve, points, *from) : std::nullopt;
    // The second must be better beyond rounding, or a fit would not be the same twice.
    if (refined && (!best || refined->squares < best->squares * (1 - 1e-9))) best = refined;
  }
  if (!best) refuse_curve(curve.model());
  return best->curve;
}

/// A lens must be able to have the curve, and every curve must lead somewhere.
void require_sense(const CalibrationCurve& curve, std::span<const CalibrationPoint> points) {
  const auto objection = curve.model().formula().objection;
  const char* const why = objection != nullptr ? objection(curve.b()) : nullptr;
  if (why != nullptr) refuse(why);
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
  const auto size = static_cast<std::size_t>(curve.size());
  const double scale = curve.position_scale();
  Matrix jacobian(kept.size(), size);
  double squares = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const CalibrationCurve::Vector gradient = curve.gradient(kept[i].distance_mm);
    for (std::size_t j = 0; j < size; ++j) jacobian(i, j) = gradient[j] / scale;
    squares += std::pow(kept[i].position - curve.position_for(kept[i].distance_mm), 2);
  }
  CurveFit fit;
  fit.curve = curve;
  fit.left_out = std::move(left_out);
  fit.freedom = static_cast<int>(kept.size()) - curve.size();
  if (fit.freedom > 0) fit.scatter = std::sqrt(squares / fit.freedom);
  const Matrix spread = normal_inverse(jacobian).matrix;
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) fit.spread[i][j] = spread(i, j) / scale / scale;
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
