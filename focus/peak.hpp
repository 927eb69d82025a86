// SPDX-License-Identifier: Apache-2.0
// Where between the evaluated positions the focus lies: a fit of the peak's shape (Xiong & Shafer
// 1993 reached 1 part in 1000 so; the thesis took the best position evaluated, T9).
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "curve.hpp"

namespace fathom {

/// Where the answer comes from.
enum class PeakMethod {
  fit,        ///< A fitted shape; the answer may lie between the lens's positions.
  evaluated,  ///< The best position evaluated, as in the thesis.
};

/// "fit", "evaluated".
const char* to_string(PeakMethod method) noexcept;
/// Throws Error(bad_argument), listing the names, for another.
PeakMethod parse_peak_method(std::string_view name);

/// The shape that described the peak.
enum class PeakShape {
  none,        ///< Too few points for any: the best position evaluated.
  parabola,    ///< Through the best position and its neighbours.
  gaussian,    ///< floor + height exp(-ln 2 ((p - position) / half_width)^2)
  lorentzian,  ///< floor + height / (1 + ((p - position) / half_width)^2)
};

/// "none", "parabola", "gaussian", "lorentzian".
const char* to_string(PeakShape shape) noexcept;

/// How far scores may be trusted, alike everywhere: a sensor's noise adds as much to the spectrum
/// of a sharp picture as of a blurred one. What grows with the score, as a lamp's flicker, shows in
/// the residuals of a fit.
struct ScoreNoise {
  double sigma = 0;    ///< Standard deviation of a score; 0 where it is not known.
  double freedom = 0;  ///< Degrees of freedom that it was learned from; 0 where it is not known.
};

/// A peak of the focus curve. Positions in the lens's unit, scores as the metric gives them.
struct Peak {
  PeakShape shape = PeakShape::none;
  double position = 0;
  /// Standard uncertainty of the position: from the scatter of the points about the shape and the
  /// repeatability of a score, pooled; where no shape fits, of a position that may lie anywhere
  /// between the neighbours.
  double sigma = 0;
  double score = 0;       ///< The fitted score there; the evaluated one where there is no shape.
  double half_width = 0;  ///< Half of the width at half the height above the floor; 0 if unknown.
  /// Part of the points' variance that the shape explains, 0..1; 0 where no point is left over to
  /// judge it by.
  double r_squared = 0;
  int points = 0;      ///< How many evaluations the shape was fitted to.
  int parameters = 0;  ///< How many parameters it has.

  /// Whether points were left over to judge the shape by.
  bool is_judged() const { return points > parameters; }
};

/// The peak of one lobe of a curve. curve: sorted by position, no position twice, the lobe's part
/// alone; best: index of its highest evaluation; floor: score far from any focus. Uses the points
/// on the upper half of what stands above both ends of the lobe, or three quarters of it where
/// those are few, and the neighbours. Never throws for odd curves: what does not fit falls back to
/// a parabola, and to the best position evaluated.
Peak fit_peak(std::span<const Evaluation> curve, std::size_t best, double floor,
              const ScoreNoise& noise);

/// Height above the floor of a shape that is 1 high and 1 in half width, `far` from its top; 0 of none.
double height_at(PeakShape shape, double far);

/// The evaluated position instead of a shape; sigma: of a position that may lie anywhere within
/// `interval`.
Peak evaluated_peak(const Evaluation& best, double interval);

}  // namespace fathom
