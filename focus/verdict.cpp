// SPDX-License-Identifier: Apache-2.0
#include "focus/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

namespace fathom {
namespace {

/// The best evaluation is the first or last, and no shape puts the peak clearly inside.
bool is_at_limit(std::span<const Evaluation> curve, const Peak& peak) {
  const std::size_t best = index_of_best(curve);
  if (best != 0 && best + 1 != curve.size()) return false;
  const double inside =
      best == 0 ? peak.position - curve.front().position : curve.back().position - peak.position;
  return !(peak.is_judged() && inside > 3 * peak.sigma);
}

/// Height of the second lobe over that of the first.
double second_part(std::span<const Evaluation> curve, std::span<const Peak> peaks) {
  if (peaks.size() < 2) return 0;
  const double floor = floor_of(curve), first = peaks[0].score - floor;
  return first > 0 ? std::clamp((peaks[1].score - floor) / first, 0.0, 1.0) : 0;
}

/// Whether a shape describes the points, by R^2 or beyond chance.
bool has_shape(const Peak& peak) {
  if (!peak.is_judged() || peak.r_squared >= kLeastRSquared) return true;
  const double explained = peak.r_squared / (peak.parameters - 1);
  const double left = peak.points - peak.parameters;
  const double f = explained / ((1 - peak.r_squared) / left);
  constexpr double kChance = 0.01;
  const boost::math::fisher_f chance(peak.parameters - 1, left);
  return boost::math::cdf(boost::math::complement(chance, f)) < kChance;
}

bool all_alike(std::span<const Evaluation> curve) {
  return std::all_of(curve.begin(), curve.end(),
                     [&](const Evaluation& e) { return e.score == curve.front().score; });
}

std::string reason_of_no_focus(std::span<const Evaluation> curve, const Peak& peak,
                               const Rise& rise) {
  const std::size_t dead = curve.size() - without_dead(curve).size();
  if (curve.size() >= kFewestLive && curve.size() - dead < kFewestLive) {
    return fmt::format(
        "{} of {} pictures are black or saturated, so there is no floor to judge a focus by; set "
        "the exposure",
        dead, curve.size());
  }
  if (curve.size() == 1) {
    return "one position alone tells of no peak; try a wider --from, --to or --bracket";
  }
  if (all_alike(curve)) {
    return "every position has the very same score; does the lens move, does the camera send fresh "
           "pictures, and is the window neither black nor saturated?";
  }
  if (rise.needed >= kBoundless) {
    return "so few coefficients scatter too much to judge a focus by; use a larger window or a "
           "wider band";
  }
  if (rise.stands_out()) {
    return fmt::format(
        "the scores round {:.6g} have no shape of a peak (R^2 = {:.2f}); try --metric "
        "walsh-sequency or a band, --average, or a larger window",
        peak.position, peak.r_squared);
  }
  return fmt::format(
      "the scores rise by {:.1f} times the noise, and noise alone may give {:.1f}; try to search "
      "elsewhere, more light, or a larger window on more edges",
      rise.rise, rise.needed);
}

std::string reason(const Verdict& verdict, std::span<const Evaluation> curve,
                   std::span<const Peak> peaks) {
  switch (verdict.result) {
    case FocusResult::focused:
      return fmt::format("the peak stands {:.0f} times the noise above the floor",
                         verdict.rise.rise);
    case FocusResult::no_focus:
      return reason_of_no_focus(curve, peaks[0], verdict.rise);
    case FocusResult::at_limit:
      return fmt::format(
          "the best score is at {:g}, an end of what was searched; the focus may lie beyond it, "
          "try a wider --from, --to or --bracket",
          curve[index_of_best(curve)].position);
    case FocusResult::ambiguous:
      return fmt::format(
          "two peaks, at {:.6g} and, {:.0f} % as high, at {:.6g}: are there two objects in the "
          "window? Try a smaller --window, or --from and --to round one of them",
          peaks[0].position, 100 * second_part(curve, peaks), peaks[1].position);
  }
  return {};
}

FocusResult result_of(std::span<const Evaluation> curve, std::span<const Peak> peaks,
                      const Rise& rise) {
  const Peak& peak = peaks[0];
  if (!rise.stands_out()) return FocusResult::no_focus;
  if (is_at_limit(curve, peak)) return FocusResult::at_limit;
  if (second_part(curve, peaks) >= kAmbiguousHeight) return FocusResult::ambiguous;
  if (!has_shape(peak)) return FocusResult::no_focus;
  return FocusResult::focused;
}

double confidence_of(std::span<const Evaluation> curve, std::span<const Peak> peaks,
                     const Rise& rise) {
  if (!(rise.rise > 0)) return 0;
  const double shape = peaks[0].is_judged() ? peaks[0].r_squared : kUnjudged;
  return std::max(0.0, 1 - rise.needed / rise.rise) * shape * (1 - second_part(curve, peaks));
}

}  // namespace

const char* to_string(FocusResult result) noexcept {
  switch (result) {
    case FocusResult::focused:
      return "focused";
    case FocusResult::no_focus:
      return "no-focus";
    case FocusResult::at_limit:
      return "at-limit";
    case FocusResult::ambiguous:
      return "ambiguous";
  }
  return "unknown";
}

Verdict judge(std::span<const Evaluation> curve, std::span<const Peak> peaks,
              const Scatter& scatter) {
  Verdict verdict;
  verdict.rise = rise_of(curve, scatter);
  verdict.result = result_of(curve, peaks, verdict.rise);
  const double sure = confidence_of(curve, peaks, verdict.rise);
  if (verdict.result == FocusResult::focused && sure < kLeastConfidence) {
    verdict.result = FocusResult::no_focus;
    verdict.reason = fmt::format(
        "the peak at {:.6g} is too unsure, confidence {:.2f}; try --average, more light, or a "
        "larger window on more edges",
        peaks[0].position, sure);
    return verdict;
  }
  if (verdict.result == FocusResult::focused || verdict.result == FocusResult::ambiguous)
    verdict.confidence = sure;
  verdict.reason = reason(verdict, curve, peaks);
  return verdict;
}

}  // namespace fathom
