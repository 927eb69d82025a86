// SPDX-License-Identifier: Apache-2.0
#include "focus/peak.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "engine/error.hpp"
#include "focus/distributions.hpp"
#include "focus/least_squares.hpp"

namespace fathom {
namespace {

/// Stands for the noise, as a part of the peak's height, where nothing is known of it; a factor
/// common to all points, which the residuals replace.
constexpr double kUnknown = 0.01;

/// No position is known better than to this part of the half width: a shape is only a likeness of a
/// curve, though the points of a record without noise may lie on it to the last bit.
constexpr double kFinest = 1e-3;

/// A part of the curve round one evaluation.
struct Points {
  std::vector<Evaluation> evaluations;
  std::size_t best = 0;
  double floor = 0;
  ScoreNoise noise;

  /// Where the peak is and how wide, once a first fit has said so: a shape is only a likeness, and
  /// the less it is one, the farther from the top.
  double centre = 0, half_width = 0;

  double height() const { return evaluations[best].score - floor; }
  /// Standard deviation of a score from the shape, up to a common factor where the noise is not
  /// known.
  double sigma(const Evaluation& e) const { return std::hypot(own_sigma(), unlikeness(e)); }
  /// The noise's part of that.
  double own_sigma() const { return noise.freedom > 0 ? noise.sigma : kUnknown * height(); }
  double unlikeness(const Evaluation& e) const {
    if (half_width == 0) return 0;
    constexpr double kAtHalfHeight = 0.02;  // of the height
    const double z = (e.position - centre) / half_width;
    return kAtHalfHeight * height() * std::min(z * z, 4.0);
  }
};

/// The upper half, if enough points lie there, else more of them; at least kFewest, and neighbours
/// on both sides.
Points points_of_peak(std::span<const Evaluation> curve, std::size_t best, double floor,
                      const ScoreNoise& noise) {
  constexpr double kUpper = 0.5, kMost = 0.75;
  constexpr std::size_t kPlenty = 6, kFewest = 4;
  const double dip = std::max({floor, best > 0 ? curve.front().score : floor,
                               best + 1 < curve.size() ? curve.back().score : floor});
  const double top = curve[best].score, prominence = top - dip;
  auto [first, last] = reach(curve, best, top - kUpper * prominence);
  if (last - first + 1 < kPlenty) {
    std::tie(first, last) = reach(curve, best, top - kMost * prominence);
  }
  if (first == best && first > 0) --first;
  if (last == best && last + 1 < curve.size()) ++last;
  while (last - first + 1 < kFewest && (first > 0 || last + 1 < curve.size())) {
    const bool can_left = first > 0, can_right = last + 1 < curve.size();
    const bool left =
        can_left && (!can_right || curve[best].position - curve[first - 1].position <=
                                       curve[last + 1].position - curve[best].position);
    left ? --first : ++last;
  }
  const auto part = curve.subspan(first, last - first + 1);
  return {.evaluations = {part.begin(), part.end()},
          .best = best - first,
          .floor = floor,
          .noise = noise};
}

/// Value and slope of a shape of height 1 and half width 1 at z.
std::pair<double, double> shape_at(PeakShape shape, double z) {
  if (shape == PeakShape::gaussian) {
    const double value = std::exp(-std::numbers::ln2 * z * z);
    return {value, -2 * std::numbers::ln2 * z * value};
  }
  const double value = 1 / (1 + z * z);
  return {value, -2 * z * value * value};
}

/// Parameters, made of order 1: height over the points' height, position in units of `scale` from
/// the best evaluation, logarithm of the half width over `scale`, which keeps it above 0.
struct ShapeFit {
  using Parameters = std::span<const double>;
  static constexpr int kParameters = 3;

  const Points& points;
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
double half_width_of(const Points& points) {
  const auto& e = points.evaluations;
  const double half = points.floor + points.height() / 2;
  std::size_t first = points.best, last = points.best;
  while (first > 0 && e[first].score > half) --first;
  while (last + 1 < e.size() && e[last].score > half) ++last;
  return std::max((e[last].position - e[first].position) / 2,
                  1e-6 * (e.back().position - e.front().position));
}

/// What is left of the points' variance.
double r_squared(const Points& points, double residual_squares) {
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
bool is_seen(const Points& points, double position, double half_width) {
  constexpr double kDown = 1.5;
  const auto& e = points.evaluations;
  const auto above = std::find_if(e.begin(), e.end(),
                                  [&](const Evaluation& one) { return one.position >= position; });
  if (above == e.begin() || above == e.end()) return false;
  return std::abs(position - e[points.best].position) <= half_width &&
         above->position - position <= kDown * half_width &&
         position - std::prev(above)->position <= kDown * half_width;
}

/// What one fit leaves: residuals in units of Points::sigma, and how the parameters move them.
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
  // Points that lie this far off are not noisy: they have another shape, and speak for themselves.
  constexpr double kBeyondNoise = 25;
  if (left > 0 && known > 0 && squares >= kBeyondNoise * left) return squares / left;
  const double few = known > 0 ? 1 : small_sample_factor(left);
  return (squares + known) / (left + known) * few;
}

/// Standard error of the position, in units of the fit's scale; nothing where the points do not
/// determine it. The weights doubt the shape; what scatters is the noise. So the covariance is that
/// of estimates with these weights under noise alone: (J'J)^-1 J'V J (J'J)^-1, V the noise's part.
std::optional<double> position_error(const Points& points, const Leftover& leftover) {
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

std::optional<Fitted> fit_shape(Points points, PeakShape shape) {
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

/// Where a Lorentzian through three evaluations has its top, as an offset from the middle one: its
/// reciprocal is a parabola.
double lorentzian_offset(const Points& points) {
  const std::size_t b = points.best;
  const auto at = [&](std::size_t i) { return points.evaluations[i].position; };
  const auto reciprocal = [&](std::size_t i) {
    const double above = points.evaluations[i].score - points.floor;
    return points.height() / std::max(above, points.own_sigma());
  };
  const double left = at(b) - at(b - 1), right = at(b + 1) - at(b);
  const double down = (reciprocal(b) - reciprocal(b - 1)) / left;
  const double up = (reciprocal(b + 1) - reciprocal(b)) / right;
  const double bend = (up - down) / (left + right);
  return bend > 0 ? std::clamp(-(down + bend * left) / (2 * bend), -left, right) : 0;
}

/// Through the best evaluation and its two neighbours; nothing at an end, or where it does not
/// bend down.
std::optional<Peak> fit_parabola(const Points& points) {
  const auto& e = points.evaluations;
  const std::size_t b = points.best;
  if (b == 0 || b + 1 == e.size()) return std::nullopt;
  const double left = e[b].position - e[b - 1].position;
  const double right = e[b + 1].position - e[b].position;
  constexpr double kUneven = 4;  // the vertex would follow from one side alone
  if (left > kUneven * right || right > kUneven * left) return std::nullopt;
  // Newton's divided differences about the best evaluation.
  const double up = (e[b].score - e[b - 1].score) / left;
  const double down = (e[b + 1].score - e[b].score) / right;
  const double bend = (down - up) / (left + right);
  if (!(bend < 0)) return std::nullopt;
  const double slope = up + bend * left;  // at the best evaluation
  const auto vertex = [&](double slope_there, double bend_there) {
    return std::clamp(-slope_there / (2 * bend_there), -left, right);
  };
  const double offset = vertex(slope, bend);
  Peak peak;
  peak.shape = PeakShape::parabola;
  peak.position = e[b].position + offset;
  peak.score = e[b].score + slope * offset + bend * offset * offset;
  peak.points = peak.parameters = 3;
  const double depth = e[b].score - points.floor;
  peak.half_width = std::sqrt(depth / 2 / -bend);
  const double gap = std::max(left, right);
  // Each score moves the vertex by its slope; without a known noise it may be anywhere near.
  double variance = gap * gap / 12;
  if (points.noise.freedom > 0) {
    variance = 0;
    for (std::size_t i = b - 1; i <= b + 1; ++i) {
      const double change = points.sigma(e[i]);
      const double p = e[i].position - e[b].position;
      double product = 1;  // of the differences that Lagrange's polynomial of point i divides by
      double sum = 0;
      for (std::size_t k = b - 1; k <= b + 1; ++k) {
        if (k == i) continue;
        product *= p - (e[k].position - e[b].position);
        sum += e[k].position - e[b].position;
      }
      const double moved = vertex(slope - change * sum / product, bend + change / product);
      variance += (moved - offset) * (moved - offset);
    }
  }
  // Far down a peak's slopes it is no parabola: how far another shape has its top from this one's.
  const double apart = (offset - lorentzian_offset(points)) / 2;
  const double scatter = std::sqrt(variance * small_sample_factor(points.noise.freedom));
  peak.sigma = std::max(std::hypot(scatter, apart), kFinest * peak.half_width);
  return peak;
}

/// The better one of both shapes; what they disagree by is what a shape is uncertain by.
std::optional<Peak> fit_shapes(const Points& points) {
  const auto gaussian = fit_shape(points, PeakShape::gaussian);
  const auto lorentzian = fit_shape(points, PeakShape::lorentzian);
  if (!gaussian && !lorentzian) return std::nullopt;
  if (!gaussian || !lorentzian) return (gaussian ? gaussian : lorentzian)->peak;
  const bool first = gaussian->chi_squared <= lorentzian->chi_squared;
  Peak peak = first ? gaussian->peak : lorentzian->peak;
  const double apart = gaussian->peak.position - lorentzian->peak.position;
  peak.sigma = std::hypot(peak.sigma, apart / std::sqrt(12.0));
  return peak;
}

}  // namespace

const char* to_string(PeakMethod method) noexcept {
  return method == PeakMethod::fit ? "fit" : "evaluated";
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
  const Points points = points_of_peak(curve, best, floor, noise);
  const auto& e = points.evaluations;
  if (points.height() > 0 && e.size() >= 4) {
    if (const auto peak = fit_shapes(points)) return *peak;
  }
  if (points.height() > 0) {
    if (const auto peak = fit_parabola(points)) return *peak;
  }
  return evaluated_peak(curve[best], e.back().position - e.front().position);
}

}  // namespace fathom
