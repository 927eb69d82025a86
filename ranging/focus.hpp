// SPDX-License-Identifier: Apache-2.0
// From a rig to its best focus: sweep, or search and judge.
#pragma once

#include <optional>
#include <vector>

#include "rig.hpp"
#include "search.hpp"
#include "verdict.hpp"

namespace fathom {

/// Frames scored at the first position to learn how far the score repeats (thesis T12).
inline constexpr int kRepeatFrames = 5;

/// Where to look, as a user says it; what is absent follows from the lens.
struct FocusRequest {
  std::optional<double> from;       ///< Start of the travel to search; the lens's lowest.
  std::optional<double> to;         ///< End; the lens's highest.
  std::optional<Bracket> bracket;   ///< Skips the coarse pass.
  std::optional<double> tolerance;  ///< Of the golden section; the thesis' 2 steps.
};

/// The same, resolved: with it and the scores alone a search runs to the same end again.
struct FocusLimits {
  double from = 0;
  double to = 0;
  std::vector<double> coarse;  ///< Positions of the coarse pass; none where a bracket is given.
  double tolerance = 2;
  std::optional<Bracket> bracket;

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
  double position = 0;  ///< Best position evaluated, in the lens's unit.
  double score = 0;
  std::vector<Evaluation> evaluations;

  FocusResult result() const { return verdict.result; }
};

/// A coarse pass unless a bracket is given, then a golden section to the tolerance, then the
/// verdict. Pure: the objective may be a rig, a record or a formula.
Focus search_focus(const Objective& objective, const FocusLimits& limits, const MetricSpec& spec,
                   double repeat_scatter);

/// What a sweep takes when no step is asked for: every stop of a lens that has only certain ones,
/// else some hundred positions.
std::vector<double> sweep_positions(const Lens& lens, double from, double to);

/// Positions of a sweep: from, from + step, ... up to and including `to`, each as the lens would
/// take it, none twice. Throws Error(bad_argument) for a step that is not above zero or more than a
/// million positions.
std::vector<double> sweep_positions(const Lens& lens, double from, double to, double step);

}  // namespace fathom
