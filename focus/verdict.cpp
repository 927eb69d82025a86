// SPDX-License-Identifier: Apache-2.0
#include "focus/verdict.hpp"

#include <algorithm>
#include <cmath>

#include "focus/distributions.hpp"

namespace fathom {
namespace {

/// What is judged, and what judging it asks for more than once.
struct Case {
  const FocusCurve& curve;
  std::span<const Peak> peaks;
  Rise rise;
  double second_part;  ///< Height of the second lobe over that of the first; 0 with one lobe.

  const Peak& peak() const { return peaks[0]; }
};

double second_part_of(const FocusCurve& curve, std::span<const Peak> peaks) {
  if (peaks.size() < 2) return 0;
  const double first = peaks[0].score - curve.floor();
  return first > 0 ? std::clamp((peaks[1].score - curve.floor()) / first, 0.0, 1.0) : 0;
}

/// The best evaluation is the first or last, and no shape puts the peak clearly inside.
bool is_at_limit(const FocusCurve& curve, const Peak& peak) {
  const std::size_t best = curve.best();
  if (best != 0 && best + 1 != curve.size()) return false;
  const double inside =
      best == 0 ? peak.position - curve.front().position : curve.back().position - peak.position;
  return !(peak.is_judged() && inside > 3 * peak.sigma);
}

/// Whether a shape describes the points, by R^2 or beyond chance.
bool has_shape(const Peak& peak) {
  if (!peak.is_judged() || peak.r_squared >= kLeastRSquared) return true;
  const double explained = peak.r_squared / (peak.parameters - 1);
  const double left = peak.points - peak.parameters;
  const double f = explained / ((1 - peak.r_squared) / left);
  constexpr double kChance = 0.01;
  return fisher_beyond(f, peak.parameters - 1, left) < kChance;
}

bool all_alike(const FocusCurve& curve) {
  const auto& all = curve.evaluations();
  return std::all_of(all.begin(), all.end(),
                     [&](const Evaluation& e) { return e.score == curve.front().score; });
}

Why why_no_focus(const Case& judged) {
  const FocusCurve& curve = judged.curve;
  if (curve.size() >= kFewestLive && curve.live().size() < kFewestLive) return Why::dead_pictures;
  if (curve.size() == 1) return Why::one_position;
  if (all_alike(curve)) return Why::all_alike;
  if (judged.rise.needed >= kBoundless) return Why::too_wild;
  return judged.rise.stands_out() ? Why::no_shape : Why::within_noise;
}

Why why(FocusResult result, const Case& judged) {
  switch (result) {
    case FocusResult::focused:
      return Why::stands_out;
    case FocusResult::no_focus:
      return why_no_focus(judged);
    case FocusResult::at_limit:
      return Why::at_end;
    case FocusResult::ambiguous:
      return Why::two_peaks;
  }
  return Why::unknown;
}

FocusResult result_of(const Case& judged) {
  if (!judged.rise.stands_out()) return FocusResult::no_focus;
  if (is_at_limit(judged.curve, judged.peak())) return FocusResult::at_limit;
  if (judged.second_part >= kAmbiguousHeight) return FocusResult::ambiguous;
  if (!has_shape(judged.peak())) return FocusResult::no_focus;
  return FocusResult::focused;
}

double confidence_of(const Case& judged) {
  const Rise& rise = judged.rise;
  if (!(rise.rise > 0)) return 0;
  const double shape = judged.peak().is_judged() ? judged.peak().r_squared : kUnjudged;
  return std::max(0.0, 1 - rise.needed / rise.rise) * shape * (1 - judged.second_part);
}

Reason reason_of(FocusResult result, const Case& judged, double confidence) {
  const bool at_end = result == FocusResult::at_limit;
  return {.why = why(result, judged),
          .position = at_end ? judged.curve.top().position : judged.peak().position,
          .r_squared = judged.peak().r_squared,
          .confidence = confidence,
          .second_position = judged.peaks.size() > 1 ? judged.peaks[1].position : 0,
          .second_part = judged.second_part,
          .evaluations = static_cast<int>(judged.curve.size()),
          .dead = static_cast<int>(judged.curve.dead())};
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

const char* to_string(Why why) noexcept {
  switch (why) {
    case Why::unknown:
      return "unknown";
    case Why::stands_out:
      return "stands-out";
    case Why::dead_pictures:
      return "dead-pictures";
    case Why::one_position:
      return "one-position";
    case Why::all_alike:
      return "all-alike";
    case Why::too_wild:
      return "too-wild";
    case Why::within_noise:
      return "within-noise";
    case Why::no_shape:
      return "no-shape";
    case Why::unsure:
      return "unsure";
    case Why::at_end:
      return "at-end";
    case Why::two_peaks:
      return "two-peaks";
  }
  return "unknown";
}

Verdict judge(const FocusCurve& curve, std::span<const Peak> peaks, const Scatter& scatter) {
  const Case judged{curve, peaks, rise_of(curve, scatter), second_part_of(curve, peaks)};
  const FocusResult result = result_of(judged);
  const double sure = confidence_of(judged);
  Verdict verdict{result, judged.rise, 0, reason_of(result, judged, sure)};
  if (result == FocusResult::focused && sure < kLeastConfidence) {
    verdict.result = FocusResult::no_focus;
    verdict.reason.why = Why::unsure;
  } else if (result == FocusResult::focused || result == FocusResult::ambiguous) {
    verdict.confidence = sure;
  }
  return verdict;
}

}  // namespace fathom
