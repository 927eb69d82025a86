// SPDX-License-Identifier: Apache-2.0
// The part of a curve that a peak is fitted to.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "peak.hpp"

namespace fathom {

/// Stands for the noise, as a part of the peak's height, where nothing is known of it; a factor
/// common to all points, which the residuals replace.
inline constexpr double kUnknown = 0.01;

/// No position is known better than to this part of the half width: a shape is only a likeness of a
/// curve, though the points of a run without noise may lie on it to the last bit.
inline constexpr double kFinest = 1e-3;

/// A part of the curve round one evaluation.
struct PeakPoints {
  std::vector<Evaluation> evaluations;
  std::size_t best = 0;
  double floor = 0;
  ScoreNoise noise;

  /// Where the peak is and how wide, once a first fit has said so: a shape is only a likeness, and
  /// the less it is one, the farther from the top.
  double centre = 0, half_width = 0;

  /// The wider one of the intervals beside the best evaluation.
  double gap() const {
    const auto at = [this](std::size_t i) { return evaluations[i].position; };
    const double left = best > 0 ? at(best) - at(best - 1) : 0;
    const double right = best + 1 < evaluations.size() ? at(best + 1) - at(best) : 0;
    return std::max(left, right);
  }
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

/// The upper half, if enough points lie there, else more of them; at least four, and neighbours on
/// both sides.
PeakPoints points_of_peak(std::span<const Evaluation> curve, std::size_t best, double floor,
                          const ScoreNoise& noise);

/// Through the best evaluation and its two neighbours; nothing at an end, or where it does not
/// bend down.
std::optional<Peak> fit_parabola(const PeakPoints& points);

}  // namespace fathom
