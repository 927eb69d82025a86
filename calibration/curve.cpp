// SPDX-License-Identifier: Apache-2.0
#include "calibration/curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/error.hpp"

namespace fathom {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

constexpr CalibrationModel kModels[] = {CalibrationModel::inverse, CalibrationModel::power,
                                        CalibrationModel::thin_lens};

}  // namespace

const char* to_string(CalibrationModel model) noexcept {
  switch (model) {
    case CalibrationModel::inverse:
      return "inverse";
    case CalibrationModel::power:
      return "power";
    case CalibrationModel::thin_lens:
      return "thin-lens";
  }
  return "unknown";
}

std::span<const CalibrationModel> calibration_models() { return kModels; }

CalibrationModel parse_calibration_model(std::string_view name) {
  for (const CalibrationModel model : kModels) {
    if (name == to_string(model)) return model;
  }
  throw Error(
      ErrorCode::bad_argument,
      fmt::format("no calibration model \"{}\"; there are inverse, power and thin-lens", name));
}

int parameter_count(CalibrationModel model) { return model == CalibrationModel::thin_lens ? 3 : 2; }

CalibrationCurve::CalibrationCurve(CalibrationModel model, std::span<const CalibrationPoint> points)
    : model_(model) {
  const auto [near, far] = std::minmax_element(
      points.begin(), points.end(), [](const CalibrationPoint& a, const CalibrationPoint& b) {
        return a.distance_mm < b.distance_mm;
      });
  const auto [low, high] = std::minmax_element(
      points.begin(), points.end(),
      [](const CalibrationPoint& a, const CalibrationPoint& b) { return a.position < b.position; });
  distance_origin_ = near->distance_mm;
  if (model_ == CalibrationModel::power) {
    distance_scale_ = std::log(far->distance_mm) - std::log(near->distance_mm);
  } else {
    distance_scale_ = far->distance_mm - near->distance_mm;
  }
  if (model_ == CalibrationModel::thin_lens) {
    position_origin_ = low->position;
    position_scale_ = high->position - low->position;
  } else {
    position_scale_ = high->position;  // Their zero means something, so only the unit is free.
  }
}

double CalibrationCurve::t_of(double distance_mm) const {
  if (model_ != CalibrationModel::power) return (distance_mm - distance_origin_) / distance_scale_;
  return (std::log(distance_mm) - std::log(distance_origin_)) / distance_scale_;
}

double CalibrationCurve::distance_of(double t) const {
  if (model_ != CalibrationModel::power) return distance_origin_ + distance_scale_ * t;
  return distance_origin_ * std::exp(distance_scale_ * t);
}

double CalibrationCurve::u_at(double t) const {
  switch (model_) {
    case CalibrationModel::inverse: {
      const double inverse = b_[0] + b_[1] * t;
      return inverse > 0 ? 1 / inverse : kNaN;
    }
    case CalibrationModel::power:
      return std::exp(b_[0] + b_[1] * t);
    case CalibrationModel::thin_lens: {
      const double beyond_focal_length = 1 + b_[2] * t;
      return beyond_focal_length > 0 ? b_[0] + b_[1] * t / beyond_focal_length : kNaN;
    }
  }
  return kNaN;
}

double CalibrationCurve::t_at(double u) const {
  switch (model_) {
    case CalibrationModel::inverse:
      if (u > 0) return (1 / u - b_[0]) / b_[1];
      return b_[1] > 0 ? kInfinity : kNaN;
    case CalibrationModel::power:
      if (u > 0) return (std::log(u) - b_[0]) / b_[1];
      return b_[1] < 0 ? kInfinity : kNaN;
    case CalibrationModel::thin_lens: {
      const double w = u - b_[0];
      const double left = b_[1] - b_[2] * w;  // Of the way to the focus on infinity.
      return left / b_[1] > 0 ? w / left : kInfinity;
    }
  }
  return kNaN;
}

double CalibrationCurve::position_for(double distance_mm) const {
  return position_origin_ + position_scale_ * u_at(t_of(distance_mm));
}

double CalibrationCurve::distance_mm(double position) const {
  if (!std::isfinite(position)) return kNaN;
  return distance_of(t_at(u_of(position)));
}

double CalibrationCurve::slope_mm(double position) const {
  const double u = u_of(position);
  switch (model_) {
    case CalibrationModel::inverse:
      return -distance_scale_ / (b_[1] * u * u * position_scale_);
    case CalibrationModel::power:
      return distance_of(t_at(u)) * distance_scale_ / (b_[1] * u * position_scale_);
    case CalibrationModel::thin_lens: {
      const double left = b_[1] - b_[2] * (u - b_[0]);
      return distance_scale_ * b_[1] / (left * left * position_scale_);
    }
  }
  return kNaN;
}

CalibrationCurve::Vector CalibrationCurve::gradient(double distance_mm) const {
  const double t = t_of(distance_mm), u = u_at(t), s = position_scale_;
  switch (model_) {
    case CalibrationModel::inverse:
      return {-s * u * u, -s * u * u * t};
    case CalibrationModel::power:
      return {s * u, s * u * t};
    case CalibrationModel::thin_lens: {
      const double reach = t / (1 + b_[2] * t);
      return {s, s * reach, -s * b_[1] * reach * reach};
    }
  }
  return {};
}

double CalibrationCurve::variance(const Matrix& spread, const Vector& gradient) const {
  double sum = 0;
  for (int i = 0; i < size(); ++i) {
    for (int j = 0; j < size(); ++j) sum += gradient[i] * spread[i][j] * gradient[j];
  }
  return std::max(0.0, sum);
}

CalibrationCurve::LinearRow CalibrationCurve::linear_row(const CalibrationPoint& point) const {
  const double t = t_of(point.distance_mm), u = u_of(point.position);
  switch (model_) {
    case CalibrationModel::inverse:
      return {{u, u * t}, 1};
    case CalibrationModel::power:
      return {{1, t}, std::log(u)};
    case CalibrationModel::thin_lens:
      return {{1, t, -t * u}, u};
  }
  return {};
}

CalibrationCurve::Vector CalibrationCurve::from_linear(const Vector& x) const {
  if (model_ != CalibrationModel::thin_lens) return x;
  return {x[0], x[1] - x[2] * x[0], x[2]};
}

std::vector<CalibrationCurve::Natural> CalibrationCurve::natural() const {
  switch (model_) {
    case CalibrationModel::inverse:
      return natural_inverse();
    case CalibrationModel::power:
      return natural_power();
    case CalibrationModel::thin_lens:
      return natural_thin_lens();
  }
  return {};
}

std::vector<CalibrationCurve::Natural> CalibrationCurve::natural_inverse() const {
  const double alpha = b_[0], beta = b_[1], span = distance_scale_;
  const double b1 = position_scale_ * span / beta;
  return {
      {"b0", distance_origin_ - alpha * span / beta, {-span / beta, alpha * span / (beta * beta)}},
      {"b1", b1, {0, -b1 / beta}}};
}

std::vector<CalibrationCurve::Natural> CalibrationCurve::natural_power() const {
  const double c = b_[1], b1 = distance_scale_ / c;
  const double log_unit = std::log(position_scale_) + b_[0];
  const double b0 = std::exp(std::log(distance_origin_) - b1 * log_unit);
  return {{"b0", b0, {-b0 * b1, b0 * b1 * log_unit / c}}, {"b1", b1, {0, -b1 / c}}};
}

std::vector<CalibrationCurve::Natural> CalibrationCurve::natural_thin_lens() const {
  const double B = b_[1], g = b_[2], span = distance_scale_;
  const double f = distance_origin_ - span / g;
  const double k = -position_scale_ * span * B / (g * g);  // position = offset + k / (d - f)
  const double f_by_g = span / (g * g);
  const double scale = f * f / k;
  return {{"focal_length_mm", f, {0, 0, f_by_g}},
          {"offset",
           position_origin_ + position_scale_ * (b_[0] + B / g),
           {position_scale_, position_scale_ / g, -position_scale_ * B / (g * g)}},
          {"scale_mm", scale, {0, -scale / B, 2 * f / k * f_by_g + 2 * scale / g}}};
}

}  // namespace fathom
