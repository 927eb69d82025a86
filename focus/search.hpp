// SPDX-License-Identifier: Apache-2.0
// Finding the sharpest lens position by as few evaluations as the curve allows (thesis T9).
// Pure: a search sees a function and limits, never hardware.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "curve.hpp"
#include "light.hpp"

namespace fathom {

/// Told of a picture of a lens that is under way; whether it should go on.
using PictureOnTheWay = std::function<bool(double position, const Sample&)>;

/// What a search looks for a maximum of.
struct Objective {
  /// Called once per position, and again only where the search wants a second look.
  std::function<Sample(double position)> score;
  /// The position that the lens would really take.
  std::function<double(double position)> nearest;
  /// Sends the lens to a position without a halt, and tells of pictures on the way, no nearer to each
  /// other than `apart`, until it is told to go on no more; then the lens halts. Where nobody knows
  /// where pictures are of, it halts by itself, and the last one told is at rest. The picture where it
  /// arrives is left to score(). Absent where every picture needs a halt.
  std::function<void(double to, double apart, const PictureOnTheWay& goes_on)> travel = {};
};

/// Evaluations in the order in which they were made. No position is evaluated twice: two positions
/// that the lens cannot tell apart share one score, as on a motor with whole steps they must.
class SearchTrace {
 public:
  /// light: how the metric takes it; as a rule scores are left as they are.
  explicit SearchTrace(Objective objective, const LightResponse& light = {})
      : objective_(std::move(objective)), light_(light) {}

  /// The score at the position nearest to `wanted`, evaluated now unless it has been.
  double score_at(double wanted);

  /// The position that the lens would take.
  double nearest(double wanted) const { return objective_.nearest(wanted); }

  /// Whether the position nearest to `wanted` has been evaluated.
  bool has(double wanted) const;

  const std::vector<Evaluation>& evaluations() const { return evaluations_; }

  /// Whether pictures can be had of a lens that does not halt.
  bool can_travel() const { return static_cast<bool>(objective_.travel); }
  /// Sends the lens to the position nearest to `wanted`. goes_on is asked after every picture on the
  /// way, passed().back(). A picture at rest is an evaluation. Where it never refused, the caller looks at that position next: so a run
  /// tells where one travel ends and the next begins.
  void travel(double wanted, double apart, const std::function<bool()>& goes_on);
  /// Pictures of a lens on its way: what spectra are looked at of, and no points of the curve.
  const std::vector<Evaluation>& passed() const { return passed_; }
  /// Evaluations and those, each in its order.
  std::vector<Evaluation> seen() const;

  /// A second look at the position nearest to `wanted`. It is no point of the curve: it tells
  /// whether the curve still holds.
  const Evaluation& look_again(double wanted);
  /// They, in the light of the curve.
  std::vector<Evaluation> second_looks() const;

  /// The first evaluation of all: this search's, or that of the one which it goes on from. None where
  /// all that is known stands in the background.
  const Evaluation* first() const {
    if (first_) return &*first_;
    return evaluations_.empty() ? nullptr : &evaluations_.front();
  }
  void began_with(const Evaluation& first) { first_ = first; }

  /// Evaluations of an earlier search that still stand for places which this one does not look at.
  void remember(std::vector<Evaluation> background) { background_ = std::move(background); }
  const std::vector<Evaluation>& background() const { return background_; }

  /// Evaluations and background, in the light that there was.
  std::vector<Evaluation> known() const;
  /// All that is known now, in one light.
  FocusCurve curve() const;
  /// The same in the light that there was.
  FocusCurve raw_curve() const;

 private:
  Evaluation evaluate(double position);
  Evaluation taken(double position, const Sample& sample) const;

  Objective objective_;
  LightResponse light_;
  std::vector<Evaluation> evaluations_;
  std::vector<Evaluation> second_looks_;
  std::vector<Evaluation> passed_;
  std::vector<Evaluation> background_;
  std::optional<Evaluation> first_;
};

/// The ways to look for the peak; focus/searches.hpp has the table of them.
enum class SearchMethod {
  automatic,  ///< `spectral` where the lens's blur is known, and `coarse` where that does not tell.
  golden,     ///< Golden section, as in the thesis.
  fibonacci,  ///< Its relative that knows beforehand how many evaluations it needs.
  brent,      ///< Parabolas, and golden sections where they fail.
  hill,       ///< Climbs from where the lens stands, in steps that become smaller.
  full,       ///< Every position.
  spectral,   ///< From where the lens stands, by the spectra of a few pictures.
  coarse,  ///< A coarse pass, then a few evaluations where a fit of the peak's shape asks for them.
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
