// SPDX-License-Identifier: Apache-2.0
// From an objective to its best focus: sweep, or search and judge.
#pragma once

#include <optional>
#include <vector>

#include "../engine/travel.hpp"
#include "auto_search.hpp"
#include "search.hpp"
#include "verdict.hpp"

namespace fathom {

/// Where and how to look, as a user says it; what is absent follows from the lens.
struct FocusRequest {
  std::optional<double> from;       ///< Start of the travel to search; the lens's lowest.
  std::optional<double> to;         ///< End; the lens's highest.
  std::optional<Bracket> bracket;   ///< Skips the coarse pass of all but `automatic`.
  std::optional<double> tolerance;  ///< Of the interval halvings; the thesis' 2 steps.
  SearchMethod search = SearchMethod::automatic;
  PeakMethod peak = PeakMethod::fit;
  std::optional<double> start;  ///< Where `hill` begins: where the lens stands.

  /// All of a part of the travel.
  static FocusRequest within(std::optional<double> from, std::optional<double> to) {
    FocusRequest request;
    request.from = from;
    request.to = to;
    return request;
  }
};

/// The same, resolved: with it and the scores alone a search runs to the same end again.
struct FocusLimits {
  double from = 0;
  double to = 0;
  CoarsePass coarse;  ///< No positions where the search begins elsewhere; of `full`, all of them.
  double tolerance = 2;
  std::optional<Bracket> bracket;
  SearchMethod search = SearchMethod::automatic;
  PeakMethod peak = PeakMethod::fit;
  double start = 0;       ///< Of `hill`.
  double first_step = 0;  ///< Of `hill`.

  bool operator==(const FocusLimits&) const = default;
};

/// Positions from `from` to `to`, both included, no further apart than the lens's coarse spacing:
/// equal intervals, or, of a lens that has only certain stops, as few of those as will do.
std::vector<double> coarse_positions(const LensInfo& lens, double from, double to);

/// Throws Error(out_of_bounds) for positions outside of the lens's travel, Error(bad_argument) for
/// a range or bracket that is upside down or a tolerance that is not above zero.
FocusLimits resolve_limits(const FocusRequest& request, const LensInfo& lens);

/// Where the focus is, and how that was found.
struct Focus {
  Verdict verdict;
  Peak peak;                ///< The answer, as limits.peak wants it.
  std::vector<Peak> lobes;  ///< Fitted peaks of all lobes, the highest first.
  std::vector<Evaluation> evaluations;
  std::vector<Evaluation> background;  ///< Of an earlier search, judged with: focus/track.hpp.
  double floor = 0;                    ///< Score far from any focus.

  FocusResult result() const { return verdict.result; }
  double position() const { return peak.position; }
};

/// Runs the search that the limits name, fits its peaks and judges them. Without a bracket
/// `golden`, `fibonacci` and `brent` start from a coarse pass as well, because on the far floor of
/// a focus curve an interval halving goes astray. Pure: the objective may be a rig, a run or a
/// formula.
Focus search_focus(const Objective& objective, const FocusLimits& limits, const MetricSpec& spec,
                   double repeat_scatter);

/// What the evaluated curve comes to: all of search_focus() that follows the search.
Focus judge_search(const SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter);

/// What a sweep takes when no step is asked for: every stop of a lens that has only certain ones,
/// else some hundred positions.
std::vector<double> sweep_positions(const LensInfo& lens, double from, double to);

/// Positions of a sweep: from, from + step, ... up to and including `to`, each as the lens would
/// take it, none twice. Throws Error(bad_argument) for a step that is not above zero or more than a
/// million positions.
std::vector<double> sweep_positions(const LensInfo& lens, double from, double to, double step);

}  // namespace fathom
