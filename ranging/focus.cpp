// SPDX-License-Identifier: Apache-2.0
#include "ranging/focus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"

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
    throw Error(
        ErrorCode::bad_argument,
        fmt::format("a coarse pass from {} to {} by {} has too many positions; give a --bracket",
                    from, to, lens.coarse_spacing));
  }
  std::vector<double> positions;
  for (double i = 0; i <= intervals; ++i) positions.push_back(from + (to - from) * i / intervals);
  return positions;
}

FocusLimits resolve_limits(const FocusRequest& request, const LensInfo& lens) {
  FocusLimits limits;
  limits.from = request.from.value_or(lens.lowest);
  limits.to = request.to.value_or(lens.highest);
  limits.tolerance = request.tolerance.value_or(kToleranceInSteps * lens.resolution);
  limits.bracket = request.bracket;
  if (limits.bracket) {
    limits.from = limits.bracket->low;
    limits.to = limits.bracket->high;
  }
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
  if (!limits.bracket) limits.coarse = coarse_positions(lens, limits.from, limits.to);
  return limits;
}

Focus search_focus(const Objective& objective, const FocusLimits& limits, const MetricSpec& spec,
                   double repeat_scatter) {
  SearchTrace trace(objective);
  if (limits.bracket) {
    golden_section(trace, *limits.bracket, limits.tolerance);
  } else {
    evaluate_all(trace, limits.coarse);
    golden_section(trace, bracket_around_best(trace.evaluations()), limits.tolerance);
  }
  Focus focus;
  focus.evaluations = trace.evaluations();
  const Evaluation& best = best_of(focus.evaluations);
  focus.position = best.position;
  focus.score = best.score;
  focus.verdict = judge(focus.evaluations, spec, repeat_scatter);
  return focus;
}

std::vector<double> sweep_positions(const Lens& lens, double from, double to) {
  const LensInfo info = lens.info();
  if (!info.stops.empty()) return stops_between(info, from, to);
  constexpr double kIntervals = 100;
  const double steps = std::ceil((to - from) / kIntervals / info.resolution);
  return sweep_positions(lens, from, to, std::max(1.0, steps) * info.resolution);
}

std::vector<double> sweep_positions(const Lens& lens, double from, double to, double step) {
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
    if (positions.empty() || lens.nearest(position) != lens.nearest(positions.back())) {
      positions.push_back(position);
    }
  }
  return positions;
}

}  // namespace fathom
