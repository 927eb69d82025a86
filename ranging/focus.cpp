// SPDX-License-Identifier: Apache-2.0
#include "ranging/focus.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/error.hpp"

namespace fathom {
namespace {

/// The thesis' tolerance of 2 steps (T9), in units of the lens's own resolution.
constexpr double kToleranceInSteps = 2;

}  // namespace

FocusLimits resolve_limits(const FocusRequest& request, const LensInfo& lens) {
  FocusLimits limits;
  limits.from = request.from.value_or(lens.lowest);
  limits.to = request.to.value_or(lens.highest);
  limits.coarse_spacing = lens.coarse_spacing;
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
  return limits;
}

Focus search_focus(const Objective& objective, const FocusLimits& limits, const MetricSpec& spec,
                   double repeat_scatter) {
  SearchTrace trace(objective);
  if (limits.bracket) {
    golden_section(trace, *limits.bracket, limits.tolerance);
  } else {
    coarse_pass(trace, limits.from, limits.to, limits.coarse_spacing);
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

std::vector<double> sweep_positions(const Lens& lens, double from, double to, double step) {
  if (!(step > 0)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a sweep by steps of {} goes nowhere; --step must "
                            "be above 0",
                            step));
  }
  constexpr double kMostPositions = 1e6;
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
