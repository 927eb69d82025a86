// SPDX-License-Identifier: Apache-2.0
// From an objective to its best focus: sweep, or search and judge.
#pragma once

#include <optional>
#include <vector>

#include "../engine/travel.hpp"
#include "auto_search.hpp"
#include "blur.hpp"
#include "first_look.hpp"
#include "parts.hpp"
#include "resemblance.hpp"
#include "search.hpp"
#include "spectral_search.hpp"
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
  std::optional<double> start;  ///< Where `hill` and `spectral` begin: where the lens stands.
  /// How the lens blurs, where that is known and pictures come with ring powers: `automatic` is
  /// then `spectral`, as far as that gets.
  std::optional<BlurModel> blur;
  /// The lens goes back to where it was when all is over: a picture there shows whether its positions
  /// still mean the same. A search by spectra looks nowhere else again that it did not just come from.
  bool returns = false;
  /// Whether pictures are taken while the lens travels, where spectra are searched by; absent: where
  /// that pays.
  std::optional<bool> moving;
  /// No more pictures than this, whatever sigma they leave (spectral_budget.hpp); three at least.
  std::optional<int> frames;

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
  double start = 0;       ///< Of `hill`, and of a search by spectra.
  double first_step = 0;  ///< Of `hill`.
  double lowest = 0;      ///< Ends of the lens's own travel.
  double highest = 0;
  /// Whether a second look can differ from the first; that of a recording cannot.
  bool is_live = false;
  bool largest_window = false;  ///< The picture has no room for a larger window of this metric.
  /// Of a search by spectra; such a search is made where it is there. `spectral` without it fits the
  /// blur together with the focus (spectral_joint.hpp).
  std::optional<BlurModel> blur;
  bool returns = false;  ///< Such a search ends with a look at its start.
  /// Such a search sees pictures on the lens's way (spectral_travel.hpp), where the objective has such.
  bool moves = false;
  int most_pictures = 0;  ///< Of a search with a budget; 0: as many as it takes.

  bool operator==(const FocusLimits&) const = default;
};

/// Positions from `from` to `to`, both included, no further apart than the lens's coarse spacing:
/// equal intervals, or, of a lens that has only certain stops, as few of those as will do.
std::vector<double> coarse_positions(const LensInfo& lens, double from, double to);

/// Throws Error(out_of_bounds) for positions outside of the lens's travel, Error(bad_argument) for
/// a range or bracket that is upside down or a tolerance that is not above zero.
FocusLimits resolve_limits(const FocusRequest& request, const LensInfo& lens);

/// Throws Error(bad_argument) unless the request knows a blur that a lens can have.
void require_blur(const FocusRequest& request);

/// Where the focus is, and how that was found.
struct Focus {
  Verdict verdict;
  Peak peak;                ///< The answer, as limits.peak wants it.
  std::vector<Peak> lobes;  ///< Fitted peaks of all lobes, the highest first.
  Depths depths;            ///< Whether all of the window is at one distance.
  std::vector<Evaluation> evaluations;
  std::vector<Evaluation> second_looks;    ///< Taken when the search was over (second_look.hpp).
  std::vector<Evaluation> background;      ///< Of an earlier search, judged with: focus/track.hpp.
  double floor = 0;                        ///< Score far from any focus.
  double lost_part = 0;                    ///< Of the frames, as doubt_for_losses() was told.
  std::optional<Resemblance> resemblance;  ///< Of the best picture, where another was looked at.
  std::optional<FirstLook> first_look;     ///< At a picture from before, where there was one.
  /// What the spectra of all pictures together say, of a search that looked at them.
  std::optional<SpectralFit> spectral;
  std::optional<SpectralEnd>
      spectral_end;  ///< How that search ended; another followed unless found.

  FocusResult result() const { return verdict.result; }
  double position() const { return peak.position; }
};

/// Runs the search that the limits name, fits its peaks and judges them. Without a bracket
/// `golden`, `fibonacci` and `brent` start from a coarse pass as well, because on the far floor of
/// a focus curve an interval halving goes astray. Pure: the objective may be a rig, a run or a
/// formula.
Focus search_focus(const Objective& objective, const FocusLimits& limits, const MetricSpec& spec,
                   double repeat_scatter);

/// Judges what was evaluated; where that is a focus, and the scene may have changed, looks again
/// and judges that: all of search_focus() that follows the search.
/// spectral_end: of the search by spectra that came first, if there was one.
Focus conclude_search(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter,
                      std::optional<SpectralEnd> spectral_end = {});

/// What the evaluated curve and the second looks come to.
Focus judge_search(const SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter,
                   std::optional<SpectralEnd> spectral_end = {});

/// Takes into account that a camera lost this part of its frames (0..1) while the lens moved: what
/// came in their place may be of another moment.
void doubt_for_losses(Focus& focus, double lost_part);

/// What saturated pixels of the best picture, 0..1, make of a peak's place: added to its sigma.
double saturation_sigma(double saturated, double half_width);

/// Positions of a sweep: from, from + step, ... up to and including `to`, each as the lens would
/// take it, none twice. Without a step: every stop of a lens that has only certain ones, else some
/// hundred positions. Throws Error(bad_argument) for a step that is not above zero or more than a
/// million positions.
std::vector<double> sweep_positions(const LensInfo& lens, double from, double to,
                                    std::optional<double> step = std::nullopt);

}  // namespace fathom
