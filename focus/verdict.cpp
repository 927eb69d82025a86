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
  const FocusCurve& raw;  ///< In the light that there was.
  std::span<const Peak> peaks;
  Rise rise;
  double second_part;  ///< Height of the second lobe over that of the first; 0 with one lobe.
  const Doubts& doubts;
  const Scatter& scatter;
  double dip;  ///< What is no noise between two scores.

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

/// Whether a shape describes the points, by R^2 or beyond chance. One place alone has none.
bool has_shape(const Peak& peak) {
  if (peak.shape == PeakShape::none) return false;
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

/// Mean of a fact of the pictures far from any focus.
template <class Fact>
double mean_far_from_focus(const FocusCurve& curve, Fact fact) {
  const std::vector<Evaluation> far = far_from_focus(curve);
  double sum = 0;
  for (const Evaluation& e : far) sum += fact(e.picture);
  return far.empty() ? 0 : sum / static_cast<double>(far.size());
}

double variance_of(const PictureFacts& picture) { return picture.deviation * picture.deviation; }
double noise_variance_of(const PictureFacts& picture) { return picture.noise * picture.noise; }

/// The pictures on the upper half of what rises above the floor.
std::vector<PictureFacts> high_pictures(const FocusCurve& curve) {
  std::vector<PictureFacts> pictures;
  for (const Evaluation& e : curve.live()) {
    if (e.score > curve.floor() + curve.height() / 2) pictures.push_back(e.picture);
  }
  return pictures;
}

/// Noise is white: where it alone grows, the pixels' variance grows by no more, and the score by
/// what it makes of noise. Texture varies more in what is coarser than a pixel.
bool is_noise_that_grows(const Case& judged) {
  const double noise = mean_far_from_focus(judged.curve, noise_variance_of);
  const double variance = mean_far_from_focus(judged.curve, variance_of);
  if (!(noise > 0)) return false;
  constexpr double kChance = 1.25, kTexture = 1.5;
  const double rise = judged.curve.top().score / judged.curve.floor();
  const double grown = std::sqrt(noise_variance_of(judged.curve.top().picture) / noise);
  if (rise > kChance * std::pow(grown, judged.scatter.light.exponent)) return false;
  const auto high = high_pictures(judged.curve);
  return std::all_of(high.begin(), high.end(), [&](const PictureFacts& picture) {
    return variance_of(picture) - variance < kTexture * (noise_variance_of(picture) - noise);
  });
}

/// Whether only the light makes the scores stand out: as they were, or all of each in one light.
bool is_light_that_grows(const Case& judged) {
  const FocusCurve even = wholly_in_one_light(judged.raw, judged.scatter.light.exponent);
  return !rise_of(even, judged.scatter).stands_out() ||
         !rise_of(judged.raw, judged.scatter).stands_out();
}

/// A camera whose noise is below its grey levels shows which pixels are near a step from one to the
/// next, and the light moves them over it.
bool is_between_grey_levels(const Case& judged) {
  const double far = mean_far_from_focus(judged.curve, variance_of);
  const double top = variance_of(judged.curve.top().picture);
  constexpr double kNoDither = 0.5, kLeast = 0.25;  // grey values squared
  return top > 0 && far < kNoDither && top - far < kLeast;
}

/// The best stands above both ends of what was searched.
bool passes_both_ends(const Case& judged) {
  const FocusCurve& curve = judged.curve;
  return curve.top().score - std::max(curve.front().score, curve.back().score) > judged.dip;
}

Why why_no_focus(const Case& judged) {
  const FocusCurve& curve = judged.curve;
  if (curve.size() == 1) return Why::one_position;
  if (curve.size() < kFewestLive) return Why::few_pictures;
  if (all_alike(curve)) return Why::all_alike;
  if (curve.live().size() < kFewestLive) return Why::dead_pictures;
  if (judged.rise.needed >= kBoundless) return Why::too_wild;
  if (!judged.rise.is_beyond_noise()) return Why::within_noise;
  return Why::small_rise;
}

struct Decision {
  FocusResult result;
  Why why;
};

/// The rules, in their order: the first that holds decides.
Decision decide(const Case& judged) {
  if (!judged.rise.stands_out()) {
    const bool did = rise_of(judged.raw, judged.scatter).stands_out();
    return {FocusResult::no_focus, did ? Why::light_changed : why_no_focus(judged)};
  }
  if (is_noise_that_grows(judged)) return {FocusResult::no_focus, Why::noise_changed};
  if (is_light_that_grows(judged)) return {FocusResult::no_focus, Why::light_changed};
  if (judged.doubts.light.explains_all) return {FocusResult::no_focus, Why::light_in_part};
  if (is_between_grey_levels(judged)) return {FocusResult::no_focus, Why::too_faint};
  if (is_at_limit(judged.curve, judged.peak()) || !passes_both_ends(judged))
    return {FocusResult::at_limit, Why::at_end};
  if (judged.second_part >= kAmbiguousHeight) return {FocusResult::ambiguous, Why::two_peaks};
  if (judged.doubts.depths.two.second_part >= kAmbiguousHeight)
    return {FocusResult::ambiguous, Why::two_depths};
  if (!has_shape(judged.peak())) return {FocusResult::no_focus, Why::no_shape};
  if (!judged.doubts.looks.agree) return {FocusResult::no_focus, Why::changed};
  return {FocusResult::focused, Why::stands_out};
}

/// What only one picture of a recording shows may be anything that passed by.
double support_of(const Case& judged) {
  constexpr double kOnePicture = 0.5;
  const FocusCurve& curve = judged.curve;
  const auto [first, last] =
      reach(curve.evaluations(), curve.best(), curve.floor() + curve.height() / 2);
  return first == last && !judged.doubts.is_live ? kOnePicture : 1;
}

/// A window that is not all at one distance has no one focus, nor has one whose light tells two.
double unity_of(const Case& judged) {
  const double width = judged.peak().half_width;
  const double spread = std::hypot(judged.doubts.depths.spread, judged.doubts.light_shift);
  return width > 0 ? 1 / (1 + std::pow(spread / width, 2)) : 1;
}

double confidence_of(const Case& judged) {
  const Rise& rise = judged.rise;
  if (!(rise.rise > 0)) return 0;
  const double shape = judged.peak().is_judged() ? judged.peak().r_squared : kUnjudged;
  return std::max(0.0, 1 - rise.needed / rise.rise) * shape * (1 - judged.second_part) *
         (1 - judged.doubts.saturated) * judged.doubts.light.left;
}

/// Two depths that parts of the window tell of, whatever the whole window's lobes are.
void tell_depths(const Depths::Two& two, Reason& reason) {
  reason.position = two.first;
  reason.second_position = two.second;
  reason.second_part = two.second_part;
}

const Evaluation& higher_end(const FocusCurve& curve) {
  return curve.front().score > curve.back().score ? curve.front() : curve.back();
}

Reason reason_of(const Decision& decision, const Case& judged, double confidence) {
  const bool at_end = decision.result == FocusResult::at_limit;
  Reason reason = {.why = decision.why,
                   .position = at_end ? higher_end(judged.curve).position : judged.peak().position,
                   .r_squared = judged.peak().r_squared,
                   .confidence = confidence,
                   .second_position = judged.peaks.size() > 1 ? judged.peaks[1].position : 0,
                   .second_part = judged.second_part,
                   .contrast = judged.rise.contrast,
                   .saturated = judged.doubts.saturated,
                   .light_left = judged.doubts.light.left,
                   .transform = judged.scatter.spec.transform,
                   .evaluations = static_cast<int>(judged.curve.size()),
                   .dead = static_cast<int>(judged.curve.dead())};
  if (decision.why == Why::two_depths) tell_depths(judged.doubts.depths.two, reason);
  return reason;
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
    case Why::by_spectra:
      return "by-spectra";
    case Why::too_few_frames:
      return "too-few-frames";
    case Why::dead_pictures:
      return "dead-pictures";
    case Why::one_position:
      return "one-position";
    case Why::few_pictures:
      return "few-pictures";
    case Why::all_alike:
      return "all-alike";
    case Why::too_wild:
      return "too-wild";
    case Why::within_noise:
      return "within-noise";
    case Why::small_rise:
      return "small-rise";
    case Why::light_changed:
      return "light-changed";
    case Why::light_in_part:
      return "light-in-part";
    case Why::noise_changed:
      return "noise-changed";
    case Why::too_faint:
      return "too-faint";
    case Why::no_shape:
      return "no-shape";
    case Why::unsure:
      return "unsure";
    case Why::at_end:
      return "at-end";
    case Why::unshared:
      return "unshared";
    case Why::changed:
      return "changed";
    case Why::two_depths:
      return "two-depths";
    case Why::two_peaks:
      return "two-peaks";
  }
  return "unknown";
}

Verdict judge(const FocusCurve& curve, const FocusCurve& raw, std::span<const Peak> peaks,
              const Scatter& scatter, const Doubts& doubts) {
  const Case judged{.curve = curve,
                    .raw = raw,
                    .peaks = peaks,
                    .rise = rise_of(curve, scatter),
                    .second_part = second_part_of(curve, peaks),
                    .doubts = doubts,
                    .scatter = scatter,
                    .dip = noise_of_lobes(curve, scatter)};
  const Decision decision = decide(judged);
  const FocusResult result = decision.result;
  const double sure = confidence_of(judged);
  Verdict verdict{result, judged.rise, 0, reason_of(decision, judged, sure)};
  if (result == FocusResult::focused && sure < kLeastConfidence) {
    verdict.result = FocusResult::no_focus;
    verdict.reason.why = Why::unsure;
  } else if (result == FocusResult::focused || result == FocusResult::ambiguous) {
    verdict.confidence = sure * support_of(judged) * unity_of(judged);
  }
  return verdict;
}

}  // namespace fathom
