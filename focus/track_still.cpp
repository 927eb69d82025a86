// SPDX-License-Identifier: Apache-2.0
#include "focus/track.hpp"

#include <algorithm>
#include <cmath>

#include "focus/searches.hpp"

namespace fathom {
namespace {

/// Whether the peak is the one that was followed: inside of where it was looked for, and no less
/// than half as high.
bool is_found(const Focus& now, const Focus& before, double low, double high) {
  const double height = now.peak.score - now.floor, was = before.peak.score - before.floor;
  return now.result() == FocusResult::focused && now.peak.is_judged() && now.peak.position > low &&
         now.peak.position < high && height > was / 2;
}

}  // namespace

Focus track_still_focus(const Objective& objective, const FocusLimits& limits,
                        const MetricSpec& spec, double repeat_scatter, const Focus& before) {
  std::vector<Evaluation> far = floor_seen_by(before);
  const bool has_peak = before.result() == FocusResult::focused && before.peak.half_width > 0;
  if (!has_peak || far.empty()) return search_focus(objective, limits, spec, repeat_scatter);
  const Scatter scatter(spec, repeat_scatter);
  const double at = before.peak.position, width = before.peak.half_width;
  const double low = std::max(limits.from, at - kPeakReach * width);
  const double high = std::min(limits.to, at + kPeakReach * width);
  SearchTrace trace(objective);
  trace.remember(std::move(far));
  constexpr double kSlope = 0.7;
  for (const double part : {-kSlope, 0.0, kSlope})
    trace.score_at(std::clamp(at + part * width, low, high));
  refine_peak(trace, low, high, repeat_scatter, limits.tolerance);
  Focus now = judge_search(trace, limits, scatter);
  if (is_found(now, before, low, high)) return now;
  trace.remember({});
  search_of(limits.search).run(trace, limits, scatter);
  return judge_search(trace, limits, scatter);
}

}  // namespace fathom
