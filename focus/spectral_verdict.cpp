// SPDX-License-Identifier: Apache-2.0
#include "focus/spectral_verdict.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "focus/slip.hpp"

namespace fathom {

bool is_for_noise(Why why) {
  switch (why) {
    case Why::few_pictures:
    case Why::too_wild:
    case Why::within_noise:
    case Why::small_rise:
    case Why::too_faint:
    case Why::no_shape:
    case Why::unsure:
      return true;
    case Why::unknown:
    case Why::stands_out:
    case Why::by_spectra:
    case Why::dead_pictures:
    case Why::too_few_frames:
    case Why::one_position:
    case Why::all_alike:
    case Why::light_changed:
    case Why::light_in_part:
    case Why::noise_changed:
    case Why::at_end:
    case Why::unshared:
    case Why::changed:
    case Why::two_depths:
    case Why::two_peaks:
      return false;
  }
  return false;
}

namespace {

/// Whether spectra are heard where scores tell of no focus for this reason. Light is divided out of
/// them, and what is wrong with that makes all rings rise alike, which no blur does; so those that
/// defocus as the law says, well beyond chance, are of a focus though a lamp's wandering hides it.
bool may_tell(const SpectralFit& fit, Why why) {
  constexpr double kEvidence = 5 * kLeastEvidence, kMisfit = 1.2;
  const bool is_as_foretold = fit.evidence > kEvidence && fit.misfit < kMisfit;
  return is_for_noise(why) || (why == Why::light_changed && is_as_foretold);
}

/// The mean of both places, by what each is worth, where they agree.
void refine_by(const SpectralFit& fit, Peak& peak) {
  constexpr double kSigmas = 3;
  const double apart = std::abs(fit.position - peak.position);
  if (!(peak.sigma > 0 && fit.sigma > 0) || apart > kSigmas * std::hypot(peak.sigma, fit.sigma))
    return;
  const double by_score = 1 / (peak.sigma * peak.sigma), by_law = 1 / (fit.sigma * fit.sigma);
  peak.position = (peak.position * by_score + fit.position * by_law) / (by_score + by_law);
  peak.sigma = 1 / std::sqrt(by_score + by_law);
}

void replace_by(const SpectralFit& fit, Peak& peak) {
  peak.position = fit.position;
  peak.sigma = fit.sigma;
}

/// Whether the place where the search began shows another blur at its end: steps were lost under way,
/// and every position since means another place.
bool has_slipped(const Focus& focus, const Evaluation& first, const FocusLimits& limits) {
  if (!limits.returns || focus.second_looks.empty()) return false;
  const Evaluation& last = focus.second_looks.back();
  if (first.position != last.position) return false;
  if (is_slipped(first, focus.evaluations, last)) return true;
  if (!focus.spectral) return false;
  const Evaluation both[] = {first, last};
  const CoarseChange change = coarse_change(first, last, ring_sides(both).largest);
  constexpr double kSigmas = 3.5,
                   kLeast = 0.005;  // a lamp's flicker, after its light is divided out
  return std::abs(change.part) > std::max(kSigmas * change.sigma, kLeast);
}

/// How much of the misfit an object makes that obeys the law badly; 0 for a flat one, which leaves
/// less than kObeys, for the likelihood doubts the law itself. As `fathom_honesty --kind orange` asks
/// for. What fits worse than a sure fit may is another place, and tells no more.
double disobedience(const SpectralFit& fit) {
  constexpr double kObeys = 0.9, kGrows = 5;
  return kGrows * std::max(0.0, std::min(fit.misfit, kWorstMisfit) - kObeys);
}

/// An object with several depths has no one place where scores are highest: noise hides the finest
/// texture first, and so decides which depth they see.
void doubt_depths(Peak& peak, const SpectralFit& fit) {
  constexpr double kApart = 0.06;  // half widths
  peak.sigma = std::hypot(peak.sigma, kApart * peak.half_width * std::sqrt(disobedience(fit)));
}

/// Half the width of a peak that so little blur makes that it halves no frequency of a picture, px.
constexpr double kLeastPx = 0.8;

/// The distance between the places round this one that were looked at.
double gap_at(std::span<const Evaluation> evaluations, double position) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  double before = -kNone, behind = kNone;
  for (const Evaluation& e : evaluations) {
    if (e.position <= position) before = std::max(before, e.position);
    if (e.position > position) behind = std::min(behind, e.position);
  }
  return behind - before;
}

/// Noise has made the top of a peak that the lens cannot make. The true one, which is wider, is as
/// likely anywhere within half of its own width, or between the places that were looked at.
void doubt_narrow(Focus& focus, const BlurModel& model) {
  if (could_make(focus.peak.half_width, model)) return;
  const double where =
      std::min(model.units(kLeastPx), gap_at(focus.evaluations, focus.peak.position));
  focus.peak.sigma = std::hypot(focus.peak.sigma, where / std::sqrt(12.0));
}

}  // namespace

SpectralFit doubted(SpectralFit fit) {
  fit.sigma *= std::sqrt(1 + disobedience(fit));
  return fit;
}

bool could_make(double half_width, const BlurModel& model) {
  return !(half_width > 0) || half_width * model.px_per_unit > kLeastPx;
}

void heed_spectra(Focus& focus, const Evaluation* first, const FocusLimits& limits) {
  Verdict& verdict = focus.verdict;
  if (first != nullptr && has_slipped(focus, *first, limits)) {
    if (verdict.result != FocusResult::focused && !is_for_noise(verdict.reason.why)) return;
    verdict.result = FocusResult::no_focus;
    verdict.confidence = 0;
    verdict.reason.why = Why::changed;
    verdict.reason.position = limits.start;
    return;
  }
  if (!focus.spectral) return;
  const SpectralFit fit = *focus.spectral;
  // Of a lens that blurs otherwise the law tells nothing.
  if (focus.spectral_end != SpectralEnd::nothing_changes) doubt_depths(focus.peak, fit);
  if (focus.spectral_end != SpectralEnd::found || !is_sure(fit))
    return doubt_narrow(focus, *limits.blur);
  if (verdict.result == FocusResult::focused) {
    if (limits.peak != PeakMethod::fit) return;
    if (could_make(focus.peak.half_width, *limits.blur)) return refine_by(fit, focus.peak);
    return replace_by(fit, focus.peak);
  }
  // The wide window may show something else.
  const bool is_of_the_window = fit.side == ring_sides(focus.evaluations).smallest;
  if (!is_of_the_window || verdict.result != FocusResult::no_focus ||
      !may_tell(fit, verdict.reason.why))
    return;
  verdict.result = FocusResult::focused;
  verdict.confidence = confidence_of(fit);
  verdict.reason.why = Why::by_spectra;
  verdict.reason.position = fit.position;
  verdict.reason.confidence = verdict.confidence;
  replace_by(fit, focus.peak);
}

}  // namespace fathom
