// SPDX-License-Identifier: Apache-2.0
#include "focus/peak.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/error.hpp"
#include "focus/distributions.hpp"
#include "focus/least_squares.hpp"
#include "focus/peak_points.hpp"

namespace fathom {
namespace {

/// Value and slope of a shape of height 1 and half width 1 at z.
std::pair<double, double> shape_at(PeakShape shape, double z) {
  switch (shape) {
    case PeakShape::gaussian: {
      const double value = std::exp(-std::numbers::ln2 * z * z);
      return {value, -2 * std::numbers::ln2 * z * value};
    }
    case PeakShape::lorentzian: {
      const double value = 1 / (1 + z * z);
      return {value, -2 * z * value * value};
    }
    case PeakShape::none:
    case PeakShape::parabola:  // has no height of its own to be scaled by
      break;
  }
  return {};
}

/// Parameters, made of order 1: height over the points' height, position in units of `scale` from
/// the best evaluation, logarithm of the half width over `scale`, which keeps it above 0.
struct ShapeFit {
  using Parameters = std::span<const double>;
  static constexpr int kParameters = 3;

  const PeakPoints& points;
  PeakShape shape;
  double scale;

  double z(Parameters x, const Evaluation& e) const {
    const double at = (e.position - points.evaluations[points.best].position) / scale;
    return (at - x[1]) / std::exp(x[2]);
  }
  void residuals(Parameters x, std::span<double> residuals) const {
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      const Evaluation& e = points.evaluations[i];
      const double fitted = points.floor + points.height() * x[0] * shape_at(shape, z(x, e)).first;
      residuals[i] = (e.score - fitted) / points.sigma(e);
    }
  }
  void jacobian(Parameters x, Matrix& jacobian) const {
    for (std::size_t i = 0; i < jacobian.rows(); ++i) {
      const Evaluation& e = points.evaluations[i];
      const double at = z(x, e), by = -points.height() / points.sigma(e);
      const auto [value, slope] = shape_at(shape, at);
      jacobian(i, 0) = by * value;
      jacobian(i, 1) = by * x[0] * slope * -std::exp(-x[2]);
      jacobian(i, 2) = by * x[0] * slope * -at;
    }
  }
  ResidualModel model() const {
    return {points.evaluations.size(),
            [this](Parameters x, std::span<double> all) { residuals(x, all); },
            [this](Parameters x, Matrix& all) { jacobian(x, all); }};
  }
};

/// Half the width of the points above half of the height, at least one gap.
double half_width_of(const PeakPoints& points) {
  const auto& e = points.evaluations;
  const double half = points.floor + points.height() / 2;
  std::size_t first = points.best, last = points.best;
  while (first > 0 && e[first].score > half) --first;
  while (last + 1 < e.size() && e[last].score > half) ++last;
  return std::max((e[last].position - e[first].position) / 2,
                  1e-6 * (e.back().position - e.front().position));
}

/// What is left of the points' variance.
double r_squared(const PeakPoints& points, double residual_squares) {
  double mean = 0, squares = 0, weights = 0;
  for (const Evaluation& e : points.evaluations) {
    const double weight = 1 / (points.sigma(e) * points.sigma(e));
    mean += weight * e.score;
    weights += weight;
  }
  mean /= weights;
  for (const Evaluation& e : points.evaluations)
    squares += std::pow((e.score - mean) / points.sigma(e), 2);
  return squares > 0 ? std::clamp(1 - residual_squares / squares, 0.0, 1.0) : 0;
}

struct Fitted {
  Peak peak;
  double chi_squared;
};

/// Whether the points enclose this peak closely: one of them on its upper half, and one on either
/// side not far down the slope. Else it is an invention.
bool is_seen(const PeakPoints& points, double position, double half_width) {
  constexpr double kDown = 1.5;
  const auto& e = points.evaluations;
  const auto above = std::find_if(e.begin(), e.end(),
                                  [&](const Evaluation& one) { return one.position >= position; });
  if (above == e.begin() || above == e.end()) return false;
  return std::abs(position - e[points.best].position) <= half_width &&
         above->position - position <= kDown * half_width &&
         position - std::prev(above)->position <= kDown * half_width;
}

/// What one fit leaves: residuals in units of PeakPoints::sigma, and how the parameters move them.
struct Leftover {
  std::vector<double> residuals;
  Matrix jacobian;

  Leftover(const ShapeFit& fit, std::span<const double> x)
      : residuals(fit.points.evaluations.size()), jacobian(residuals.size(), x.size()) {
    fit.residuals(x, residuals);
    fit.jacobian(x, jacobian);
  }
  double chi_squared() const {
    double sum = 0;
    for (const double residual : residuals) sum += residual * residual;
    return sum;
  }
};

/// Size of the noise in units of its own sigma, as a variance: what residuals and repeatability say
/// together, each with its degrees of freedom. part: the noise's of each point's variance.
double noise_variance(const Leftover& leftover, std::span<const double> part,
                      const ScoreNoise& noise) {
  const double known = noise.freedom;
  const auto left = static_cast<double>(part.size()) - ShapeFit::kParameters;
  double squares = 0;
  for (std::size_t k = 0; k < part.size(); ++k)
    squares += leftover.residuals[k] * leftover.residuals[k] / part[k];
  // PeakPoints that lie this far off are not noisy: they have another shape, and speak for
  // themselves.
  constexpr double kBeyondNoise = 25;
  if (left > 0 && known > 0 && squares >= kBeyondNoise * left) return squares / left;
  // What is known is of few frames, and residuals are as few. But one that is large is of the shape.
  const double few = small_sample_factor(left + known);
  if (known > 0) return (squares + known * few) / (left + known);
  return squares / left * few;
}

/// Standard error of the position, in units of the fit's scale; nothing where the points do not
/// determine it. The weights doubt the shape; what scatters is the noise. So the covariance is that
/// of estimates with these weights under noise alone: (J'J)^-1 J'V J (J'J)^-1, V the noise's part.
std::optional<double> position_error(const PeakPoints& points, const Leftover& leftover) {
  constexpr std::size_t kPosition = 1;
  const Matrix& j = leftover.jacobian;
  const NormalInverse inverse = normal_inverse(j);
  if (!inverse.is_certain) return std::nullopt;
  std::vector<double> part;
  double covariance = 0;
  for (std::size_t k = 0; k < j.rows(); ++k) {
    const double share = points.own_sigma() / points.sigma(points.evaluations[k]);
    part.push_back(share * share);
    double moves = 0;  // the position, by the k-th residual
    for (std::size_t i = 0; i < j.columns(); ++i) moves += inverse.matrix(kPosition, i) * j(k, i);
    covariance += part.back() * moves * moves;
  }
  return std::sqrt(noise_variance(leftover, part, points.noise) * covariance);
}

bool is_sound(std::span<const double> x) {
  constexpr double kHighest = 4;  // over the points' height
  return std::all_of(x.begin(), x.end(), [](double value) { return std::isfinite(value); }) &&
         x[0] > 0 && x[0] < kHighest;
}

std::optional<Fitted> fit_shape(PeakPoints points, PeakShape shape) {
  const ShapeFit fit{points, shape, half_width_of(points)};
  const double best = points.evaluations[points.best].position;
  std::vector<double> x = minimize_squares(fit.model(), {1, 0, 0});
  points.centre = best + fit.scale * x[1];
  points.half_width = fit.scale * std::exp(x[2]);
  if (std::isfinite(points.centre) && points.half_width > 0) x = minimize_squares(fit.model(), x);
  const double position = best + fit.scale * x[1], half_width = fit.scale * std::exp(x[2]);
  if (!is_sound(x) || !is_seen(points, position, half_width)) return std::nullopt;
  const Leftover leftover(fit, x);
  const auto error = position_error(points, leftover);
  if (!error) return std::nullopt;
  const double chi_squared = leftover.chi_squared();
  Peak peak;
  peak.shape = shape;
  peak.position = position;
  peak.sigma = std::max(fit.scale * *error, kFinest * half_width);
  peak.score = points.floor + points.height() * x[0];
  peak.half_width = half_width;
  peak.points = static_cast<int>(points.evaluations.size());
  peak.parameters = ShapeFit::kParameters;
  if (peak.is_judged()) peak.r_squared = r_squared(points, chi_squared);
  return Fitted{peak, chi_squared};
}

/// The better one of both shapes; what they disagree by is what a shape is uncertain by. Where only
/// one of them can be fitted, the points are so few that it is a part of their spacing. Both parts
/// are what `fathom_honesty --kind recording` asks for.
std::optional<Peak> fit_shapes(const PeakPoints& points) {
  constexpr double kOneShape = 0.08, kApart = 0.4;
  const auto gaussian = fit_shape(points, PeakShape::gaussian);
  const auto lorentzian = fit_shape(points, PeakShape::lorentzian);
  if (!gaussian && !lorentzian) return std::nullopt;
  if (!gaussian || !lorentzian) {
    Peak peak = (gaussian ? gaussian : lorentzian)->peak;
    peak.sigma = std::hypot(peak.sigma, kOneShape * points.gap());
    return peak;
  }
  const bool first = gaussian->chi_squared <= lorentzian->chi_squared;
  Peak peak = first ? gaussian->peak : lorentzian->peak;
  const double apart = gaussian->peak.position - lorentzian->peak.position;
  peak.sigma = std::hypot(peak.sigma, kApart * apart);
  return peak;
}

}  // namespace

const char* to_string(PeakMethod method) noexcept {
  switch (method) {
    case PeakMethod::fit:
      return "fit";
    case PeakMethod::evaluated:
      return "evaluated";
  }
  return "unknown";
}

PeakMethod parse_peak_method(std::string_view name) {
  for (const PeakMethod method : {PeakMethod::fit, PeakMethod::evaluated}) {
    if (name == to_string(method)) return method;
  }
  throw Error(ErrorCode::bad_argument,
              fmt::format("no peak \"{}\"; there is fit, evaluated", name));
}

const char* to_string(PeakShape shape) noexcept {
  switch (shape) {
    case PeakShape::none:
      return "none";
    case PeakShape::parabola:
      return "parabola";
    case PeakShape::gaussian:
      return "gaussian";
    case PeakShape::lorentzian:
      return "lorentzian";
  }
  return "unknown";
}

Peak evaluated_peak(const Evaluation& best, double interval) {
  Peak peak;
  peak.position = best.position;
  peak.score = best.score;
  peak.sigma = interval / std::sqrt(12.0);
  peak.points = peak.parameters = 1;
  return peak;
}

Peak fit_peak(std::span<const Evaluation> curve, std::size_t best, double floor,
              const ScoreNoise& noise) {
  const PeakPoints points = points_of_peak(curve, best, floor, noise);
  const auto& e = points.evaluations;
  if (points.height() > 0 && e.size() >= 4) {
    if (const auto peak = fit_shapes(points)) return *peak;
  }
  if (points.height() > 0) {
    if (const auto peak = fit_parabola(points)) return *peak;
  }
  return evaluated_peak(curve[best], e.back().position - e.front().position);
}

double height_at(PeakShape shape, double far) {
  return shape == PeakShape::parabola ? 1 - far * far / 2 : shape_at(shape, far).first;
}

}  // namespace fathom
