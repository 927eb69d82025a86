// SPDX-License-Identifier: Apache-2.0
#include "focus/distributions.hpp"
#include "focus/peak_points.hpp"

namespace fathom {
namespace {

/// Where a Lorentzian through three evaluations has its top, as an offset from the middle one: its
/// reciprocal is a parabola.
double lorentzian_offset(const PeakPoints& points) {
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

/// A parabola through three points, about the middle one: value + slope p + bend p^2.
struct Parabola {
  double left = 0, right = 0;  ///< How far the neighbours are.
  double slope = 0, bend = 0;

  /// Where the vertex of a parabola of this slope and bend is, no farther than the neighbours.
  double vertex(double its_slope, double its_bend) const {
    return std::clamp(-its_slope / (2 * its_bend), -left, right);
  }
  double offset() const { return vertex(slope, bend); }
};

/// Through the best evaluation and its neighbours, by Newton's divided differences.
Parabola parabola_of(const PeakPoints& points) {
  const auto& e = points.evaluations;
  const std::size_t b = points.best;
  Parabola parabola;
  parabola.left = e[b].position - e[b - 1].position;
  parabola.right = e[b + 1].position - e[b].position;
  const double up = (e[b].score - e[b - 1].score) / parabola.left;
  const double down = (e[b + 1].score - e[b].score) / parabola.right;
  parabola.bend = (down - up) / (parabola.left + parabola.right);
  parabola.slope = up + parabola.bend * parabola.left;
  return parabola;
}

/// Variance of the vertex: each score moves it by its slope; without a known noise it may be
/// anywhere near.
double vertex_variance(const PeakPoints& points, const Parabola& parabola) {
  const auto& e = points.evaluations;
  const std::size_t b = points.best;
  const double gap = std::max(parabola.left, parabola.right);
  if (!(points.noise.freedom > 0)) return gap * gap / 12;
  double variance = 0;
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
    const double moved =
        parabola.vertex(parabola.slope - change * sum / product, parabola.bend + change / product);
    variance += (moved - parabola.offset()) * (moved - parabola.offset());
  }
  return variance;
}

}  // namespace

std::optional<Peak> fit_parabola(const PeakPoints& points) {
  const auto& e = points.evaluations;
  const std::size_t b = points.best;
  if (b == 0 || b + 1 == e.size()) return std::nullopt;
  const Parabola parabola = parabola_of(points);
  constexpr double kUneven = 4;  // the vertex would follow from one side alone
  if (parabola.left > kUneven * parabola.right || parabola.right > kUneven * parabola.left)
    return std::nullopt;
  if (!(parabola.bend < 0)) return std::nullopt;
  const double offset = parabola.offset();
  Peak peak;
  peak.shape = PeakShape::parabola;
  peak.position = e[b].position + offset;
  peak.score = e[b].score + parabola.slope * offset + parabola.bend * offset * offset;
  peak.points = peak.parameters = 3;
  const double depth = e[b].score - points.floor;
  peak.half_width = std::sqrt(depth / 2 / -parabola.bend);
  // Far down a peak's slopes it is no parabola: how far another shape has its top from this one's.
  const double apart = (offset - lorentzian_offset(points)) / 2;
  const double variance = vertex_variance(points, parabola);
  // Nothing is left over to judge the shape by: a part of the spacing is the least that it errs by.
  constexpr double kUnjudgedPart = 0.1;
  const double scatter = std::sqrt(variance * small_sample_factor(points.noise.freedom));
  peak.sigma =
      std::max(std::hypot(scatter, apart, kUnjudgedPart * points.gap()), kFinest * peak.half_width);
  return peak;
}

}  // namespace fathom
