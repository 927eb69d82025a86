// SPDX-License-Identifier: Apache-2.0
#include "focus/focus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "focus/lobes.hpp"

namespace fathom {
namespace {

/// The thesis' tolerance of 2 steps (T9), in units of the lens's own resolution.
constexpr double kToleranceInSteps = 2;

/// More than any rig has; a mistyped step or spacing is refused before it takes a week.
constexpr double kMostPositions = 1e6;

/// The stops from `from` to `to`; the one nearest to them if there is none between.
std::vector<double> stops_between(const LensInfo& lens, double from, double to) {
  const auto first = std::lower_bound(lens.stops.begin(), lens.stops.end(), from);
  const auto last = std::upper_bound(first, lens.stops.end(), to);
  if (first == last) return {nearest_position(lens, from)};
  return {first, last};
}

/// As few stops as leave no gap above the spacing, where the stops themselves leave none.
std::vector<double> thinned(const std::vector<double>& stops, double spacing) {
  std::vector<double> kept = {stops.front()};
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const bool last = i + 1 == stops.size();
    if (last || stops[i + 1] - kept.back() > spacing) kept.push_back(stops[i]);
  }
  return kept;
}

}  // namespace

std::vector<double> coarse_positions(const LensInfo& lens, double from, double to) {
  if (!lens.stops.empty()) return thinned(stops_between(lens, from, to), lens.coarse_spacing);
  // Intervals are made equal, so that the last is no sliver; the small excess is for division's
  // rounding.
  const double intervals = std::max(1.0, std::ceil((to - from) / lens.coarse_spacing - 1e-9));
  if (!(intervals <= kMostPositions)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a coarse pass from {} to {} by {} has too many positions; give a "
                            "--bracket, or a larger --tolerance",
                            from, to, lens.coarse_spacing));
  }
  std::vector<double> positions;
  for (double i = 0; i <= intervals; ++i) positions.push_back(from + (to - from) * i / intervals);
  return positions;
}

namespace {

/// A lens that says nothing of its depth of focus gets this many positions first, and halvings
/// until the peak shows, or the lens has no positions in between.
constexpr double kGuessedIntervals = 8;
constexpr int kGuessedHalvings = 5;

CoarsePass coarse_pass(const LensInfo& lens, const FocusLimits& limits) {
  CoarsePass pass;
  pass.is_guess = !(lens.coarse_spacing > 0);
  LensInfo spaced = lens;
  if (pass.is_guess) {
    spaced.coarse_spacing =
        std::max((limits.to - limits.from) / kGuessedIntervals, lens.resolution);
  }
  pass.halvings = pass.is_guess ? kGuessedHalvings : 1;
  pass.positions = coarse_positions(spaced, limits.from, limits.to);
  return pass;
}

/// Every position a tolerance apart, and every stop of a lens that has only certain ones.
CoarsePass full_pass(const LensInfo& lens, const FocusLimits& limits) {
  LensInfo spaced = lens;
  spaced.coarse_spacing = lens.stops.empty() ? limits.tolerance : 0;
  return {coarse_positions(spaced, limits.from, limits.to), 0, false};
}

/// Of a climb. Half of the widest spacing that hides no peak, but one that the lens can make: a
/// step that it rounds to nothing looks like a top.
double first_step(const LensInfo& lens, double travel) {
  if (!(lens.coarse_spacing > 0)) return std::max(travel / kGuessedIntervals, lens.resolution);
  if (!lens.stops.empty()) return lens.coarse_spacing;
  return std::max(lens.coarse_spacing / 2, lens.resolution);
}

void require_limits(const FocusLimits& limits, const LensInfo& lens) {
  require_within(lens, limits.from);
  require_within(lens, limits.to);
  if (limits.from > limits.to) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("--from {} lies beyond --to {}; swap them", limits.from, limits.to));
  }
  if (!(limits.tolerance > 0 && std::isfinite(limits.tolerance))) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a tolerance of {} {} ends no search; it must be above 0",
                            limits.tolerance, lens.unit));
  }
}

}  // namespace

FocusLimits resolve_limits(const FocusRequest& request, const LensInfo& lens) {
  FocusLimits limits;
  limits.search = request.search;
  limits.peak = request.peak;
  limits.from = request.from.value_or(lens.lowest);
  limits.to = request.to.value_or(lens.highest);
  limits.tolerance = request.tolerance.value_or(kToleranceInSteps * lens.resolution);
  limits.bracket = request.bracket;
  if (limits.bracket) {
    limits.from = limits.bracket->low;
    limits.to = limits.bracket->high;
  }
  require_limits(limits, lens);
  const bool is_auto = limits.search == SearchMethod::automatic;
  if (limits.search == SearchMethod::full) {
    limits.coarse = full_pass(lens, limits);
  } else if (limits.search == SearchMethod::hill) {
    const double start =
        limits.bracket ? limits.bracket->inner : request.start.value_or(limits.from);
    limits.start = std::clamp(start, limits.from, limits.to);
    limits.first_step = std::max(first_step(lens, limits.to - limits.from), limits.tolerance);
  } else if (is_auto || !limits.bracket) {
    limits.coarse = coarse_pass(lens, limits);
  }
  return limits;
}

namespace {

/// The searches that narrow an interval down: within the bracket, or round the best of a coarse
/// pass.
void narrow(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter) {
  if (!limits.bracket) run_coarse_pass(trace, limits.coarse, scatter);
  const Bracket bracket =
      limits.bracket ? *limits.bracket : bracket_around_best(trace.evaluations());
  if (limits.search == SearchMethod::golden) {
    golden_section(trace, bracket, limits.tolerance);
  } else if (limits.search == SearchMethod::fibonacci) {
    fibonacci_section(trace, bracket.low, bracket.high, limits.tolerance);
  } else {
    brent(trace, bracket.low, bracket.high, limits.tolerance);
  }
}

}  // namespace

void run_search(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter) {
  switch (limits.search) {
    case SearchMethod::automatic:
      return auto_search(trace, limits.coarse, scatter, limits.tolerance);
    case SearchMethod::golden:
    case SearchMethod::fibonacci:
    case SearchMethod::brent:
      return narrow(trace, limits, scatter);
    case SearchMethod::hill:
      return hill_climb(trace, limits.start, limits.first_step, limits.from, limits.to,
                        limits.tolerance);
    case SearchMethod::full:
      return evaluate_all(trace, limits.coarse.positions);
  }
}

namespace {

/// A dip that is shallower than this part of the best peak does not part it in two.
constexpr double kShallow = 0.15;

/// The lobes of a curve, in running means as wide as its noise asks for and its length allows.
std::vector<Lobe> lobes_of(const FocusCurve& curve, const Scatter& scatter) {
  const double noise = noise_of_lobes(curve, scatter);
  for (const std::size_t width : {1, 3, 5}) {
    const FocusCurve means = smoothed(curve, width);
    const double shallow = kShallow * means.height();
    const double dip = noise / std::sqrt(static_cast<double>(width));
    const bool is_last = width == 5 || curve.size() < kDense;
    if (dip <= shallow || is_last) return find_lobes(means, std::max(shallow, dip));
  }
  return {};
}

/// How far apart the halfway points to the best evaluation's neighbours are: what lies between them
/// is nearest to it.
double interval_of_best(const FocusCurve& curve) {
  const std::size_t best = curve.best();
  const double low = curve[best > 0 ? best - 1 : best].position;
  const double high = curve[std::min(best + 1, curve.size() - 1)].position;
  return (high - low) / 2;
}

/// The peak of every lobe that is more than noise, the highest first.
std::vector<Peak> peaks_of(const FocusCurve& curve, const Scatter& scatter) {
  const ScoreNoise noise = noise_of(scatter.repeat, curve.floor());
  const std::span<const Evaluation> all = curve.evaluations();
  std::vector<Peak> peaks;
  for (const Lobe& lobe : lobes_of(curve, scatter)) {
    const auto part = all.subspan(lobe.first, lobe.last - lobe.first + 1);
    const auto best = static_cast<std::size_t>(&best_of(part) - part.data());
    peaks.push_back(fit_peak(part, best, curve.floor(), noise));
  }
  return peaks;
}

}  // namespace

Focus judge_search(const SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter) {
  const FocusCurve curve = trace.curve();
  Focus focus;
  focus.evaluations = trace.evaluations();
  focus.background = trace.background();
  focus.floor = curve.floor();
  focus.lobes = peaks_of(curve, scatter);
  for (Peak& lobe : focus.lobes) {  // one evaluation alone has no neighbours to be unsure between
    if (!(lobe.sigma > 0)) lobe.sigma = limits.tolerance / std::sqrt(12.0);
  }
  focus.verdict = judge(curve, focus.lobes, scatter);
  focus.peak = limits.peak == PeakMethod::fit
                   ? focus.lobes[0]
                   : evaluated_peak(best_of(focus.evaluations),
                                    std::max(limits.tolerance, interval_of_best(curve)));
  return focus;
}

Focus search_focus(const Objective& objective, const FocusLimits& limits, const MetricSpec& spec,
                   double repeat_scatter) {
  const Scatter scatter(spec, repeat_scatter);
  SearchTrace trace(objective);
  run_search(trace, limits, scatter);
  return judge_search(trace, limits, scatter);
}

std::vector<double> sweep_positions(const LensInfo& lens, double from, double to) {
  if (!lens.stops.empty()) return stops_between(lens, from, to);
  constexpr double kIntervals = 100;
  const double steps = std::ceil((to - from) / kIntervals / lens.resolution);
  return sweep_positions(lens, from, to, std::max(1.0, steps) * lens.resolution);
}

std::vector<double> sweep_positions(const LensInfo& lens, double from, double to, double step) {
  if (!(step > 0 && std::isfinite(step))) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a sweep by steps of {} goes nowhere; --step must "
                            "be a number above 0",
                            step));
  }
  const double intervals = std::floor((to - from) / step + 1e-9);  // 0.3 / 0.1 is just below 3
  if (intervals > kMostPositions) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a sweep from {} to {} by {} has too many positions", from, to, step));
  }
  std::vector<double> positions;
  for (double i = 0; i <= intervals; ++i) {
    const double position = std::min(from + i * step, to);
    if (positions.empty() ||
        nearest_position(lens, position) != nearest_position(lens, positions.back())) {
      positions.push_back(position);
    }
  }
  return positions;
}

}  // namespace fathom
