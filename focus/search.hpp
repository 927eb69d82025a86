// SPDX-License-Identifier: Apache-2.0
// Finding the sharpest lens position by as few evaluations as the curve allows (thesis T9).
// Pure: a search sees a function and limits, never hardware.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "curve.hpp"

namespace fathom {

/// What a search looks for a maximum of.
struct Objective {
  /// Called at most once per position.
  std::function<double(double position)> score;
  /// The position that the lens would really take.
  std::function<double(double position)> nearest;
};

/// Evaluations in the order in which they were made. No position is evaluated twice: two positions
/// that the lens cannot tell apart share one score, as on a motor with whole steps they must.
class SearchTrace {
 public:
  explicit SearchTrace(Objective objective) : objective_(std::move(objective)) {}

  /// The score at the position nearest to `wanted`, evaluated now unless it has been.
  double score_at(double wanted);

  /// Whether the position nearest to `wanted` has been evaluated.
  bool has(double wanted) const;

  const std::vector<Evaluation>& evaluations() const { return evaluations_; }

  /// Evaluations of an earlier search that still stand for places which this one does not look at.
  void remember(std::vector<Evaluation> background) { background_ = std::move(background); }
  const std::vector<Evaluation>& background() const { return background_; }

  /// All that is known now.
  FocusCurve curve() const;

 private:
  Objective objective_;
  std::vector<Evaluation> evaluations_;
  std::vector<Evaluation> background_;
};

/// The ways to look for the peak; focus/searches.hpp has the table of them.
enum class SearchMethod {
  automatic,  ///< A coarse pass, then a few evaluations where a fit of the peak's shape asks for
              ///< them.
  golden,     ///< Golden section, as in the thesis.
  fibonacci,  ///< Its relative that knows beforehand how many evaluations it needs.
  brent,      ///< Parabolas, and golden sections where they fail.
  hill,       ///< Climbs from where the lens stands, in steps that become smaller.
  full,       ///< Every position.
};

/// Its name in the table: "auto", "golden" and so on.
const char* to_string(SearchMethod method) noexcept;
/// Throws Error(bad_argument), listing the names, for another.
SearchMethod parse_search_method(std::string_view name);

/// Three positions, low < inner < high, with the peak between the outer two.
struct Bracket {
  double low = 0;
  double inner = 0;
  double high = 0;

  bool operator==(const Bracket&) const = default;
};

/// Reads "A,X,B". Throws Error(bad_argument) unless they are three increasing numbers.
Bracket parse_bracket(std::string_view text);

/// Golden-section search for a maximum as the thesis ran it (T9, eq. 5-3; Press et al. 1986): the
/// first two evaluations are the inner point and one in the larger segment, then one a loop, until
/// the interval is no longer than the tolerance. The answer is the best position EVALUATED:
/// best_of(trace).
void golden_section(SearchTrace& trace, const Bracket& bracket, double tolerance);

/// Fibonacci search (Kiefer 1953; Krotkov 1987 for focus): the fewest evaluations after which the
/// best one lies within the tolerance of the peak, whatever the curve, if it has one peak. Throws
/// as golden_section.
void fibonacci_section(SearchTrace& trace, double low, double high, double tolerance);

/// Brent's method (1973; Boost.Math): the thesis' advice for a third fewer evaluations (T16).
/// Throws as golden_section.
void brent(SearchTrace& trace, double low, double high, double tolerance);

/// Climbs from `start`, upward first, by steps of `step` that are halved and turned round wherever
/// the score falls, until they are no longer than the tolerance; stays between low and high. Ends
/// on whatever hill it began on. Throws as golden_section.
void hill_climb(SearchTrace& trace, double start, double step, double low, double high,
                double tolerance);

/// Evaluates every one of these positions.
void evaluate_all(SearchTrace& trace, std::span<const double> positions);

/// The interval whose golden section the whole range's first evaluation is.
Bracket whole_range(double low, double high);

/// The best evaluation and its neighbours by position: where the peak must be if nothing hides
/// between samples. At an end of the range the bracket is one-sided, its inner point the golden
/// section.
Bracket bracket_around_best(std::span<const Evaluation> evaluations);

}  // namespace fathom
