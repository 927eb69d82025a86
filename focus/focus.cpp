// SPDX-License-Identifier: Apache-2.0
#include "focus/focus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/error.hpp"
#include "focus/lobes.hpp"
#include "focus/searches.hpp"
#include "focus/second_look.hpp"
#include "focus/spectral_budget.hpp"
#include "focus/spectral_joint.hpp"
#include "focus/spectral_pass.hpp"
#include "focus/spectral_side.hpp"
#include "focus/spectral_travel.hpp"
#include "focus/spectral_verdict.hpp"

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
        fmt::format("a coarse pass from {} to {} by {} has too many positions; give a bracket, "
                    "or a larger tolerance",
                    from, to, lens.coarse_spacing));
  }
  std::vector<double> positions;
  for (double i = 0; i <= intervals; ++i) positions.push_back(from + (to - from) * i / intervals);
  return positions;
}

namespace {

void require_limits(const FocusLimits& limits, const LensInfo& lens) {
  require_within(lens, limits.from);
  require_within(lens, limits.to);
  if (limits.from > limits.to) {
    throw Error(
        ErrorCode::bad_argument,
        fmt::format("a travel from {} to {} runs backwards; swap them", limits.from, limits.to));
  }
  if (!(limits.tolerance > 0 && std::isfinite(limits.tolerance))) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a tolerance of {} {} ends no search; it must be above 0",
                            limits.tolerance, lens.unit));
  }
}

}  // namespace

void require_blur(const FocusRequest& request) {
  if (request.blur) return require_valid(*request.blur);
  throw Error(ErrorCode::bad_argument,
              "a search by spectra must know how the lens blurs, and nobody has told that: sweep "
              "once, which learns it, name blur_px (px per unit of travel) in the rig file, or "
              "search with coarse");
}

namespace {

/// Two foretell where the focus is, and the third shows whether it is there.
constexpr int kFewestFrames = 3;

/// With a budget of pictures there is one way to search.
void require_budget(const FocusRequest& request) {
  if (!request.frames) return;
  if (*request.frames < kFewestFrames) {
    throw Error(
        ErrorCode::bad_argument,
        fmt::format("no focus can be told from {}: any two pictures fit one nearby; {} frames are "
                    "the least",
                    *request.frames == 1 ? "1 frame" : fmt::format("{} frames", *request.frames),
                    kFewestFrames));
  }
  if (request.search != SearchMethod::automatic && request.search != SearchMethod::spectral) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a search by {} takes as many frames as it needs; with a number of "
                            "frames search by spectra",
                            to_string(request.search)));
  }
  require_blur(request);
}

}  // namespace

FocusLimits resolve_limits(const FocusRequest& request, const LensInfo& lens) {
  require_budget(request);
  FocusLimits limits;
  limits.search = request.search;
  limits.peak = request.peak;
  limits.lowest = lens.lowest;
  limits.highest = lens.highest;
  limits.from = request.from.value_or(lens.lowest);
  limits.to = request.to.value_or(lens.highest);
  limits.tolerance = request.tolerance.value_or(kToleranceInSteps * lens.resolution);
  limits.bracket = request.bracket;
  if (limits.bracket) {
    limits.from = limits.bracket->low;
    limits.to = limits.bracket->high;
  }
  require_limits(limits, lens);
  search_of(limits.search).prepare(limits, request, lens);
  limits.returns = request.returns && limits.blur.has_value();
  limits.most_pictures = request.frames.value_or(0);
  return limits;
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
  const ScoreNoise noise = noise_of(scatter, curve);
  const std::span<const Evaluation> all = curve.evaluations();
  std::vector<Peak> peaks;
  for (const Lobe& lobe : lobes_of(curve, scatter)) {
    const auto part = all.subspan(lobe.first, lobe.last - lobe.first + 1);
    const auto best = static_cast<std::size_t>(&best_of(part) - part.data());
    peaks.push_back(fit_peak(part, best, curve.floor(), noise));
  }
  return peaks;
}

/// The peak as the limits want it.
Peak answer_of(const Focus& focus, const FocusCurve& curve, const FocusLimits& limits) {
  switch (limits.peak) {
    case PeakMethod::fit:
      return focus.lobes[0];
    case PeakMethod::evaluated:
      return evaluated_peak(best_of(focus.evaluations),
                            std::max(limits.tolerance, interval_of_best(curve)));
  }
  return {};
}

/// What the curve alone tells, which second looks do not change.
Focus shape_of(const SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter,
               std::optional<SpectralEnd> spectral_end) {
  const FocusCurve curve = trace.curve();
  Focus focus;
  focus.spectral_end = spectral_end;
  focus.evaluations = trace.evaluations();
  focus.background = trace.background();
  focus.floor = curve.floor();
  focus.lobes = peaks_of(curve, scatter);
  for (Peak& lobe : focus.lobes) {  // one evaluation alone has no neighbours to be unsure between
    if (!(lobe.sigma > 0)) lobe.sigma = limits.tolerance / std::sqrt(12.0);
  }
  focus.depths = depths_of(trace.known(), scatter.of_parts());
  if (!limits.blur) return focus;
  const std::vector<Evaluation> all =
      trace.passed().empty() ? trace.known() : thinned(trace, limits.blur->units(kFittedPx));
  const SpectralFit fit = doubted(fit_all(all, focus.lobes[0].position, limits));
  if (fit.side != 0) focus.spectral = fit;
  return focus;
}

/// How far the answer lies from that of an exposure that changed as the pictures' light did. Where that
/// is more than a lamp does, nobody knows which of the two it was.
double shift_of_light(const SearchTrace& trace, const Peak& highest, const Scatter& scatter) {
  const std::vector<Evaluation> known = trace.known();
  if (!is_beyond_a_lamp(known)) return 0;
  const std::vector<Peak> peaks =
      peaks_of(FocusCurve(in_one_exposure(known, scatter.light)), scatter);
  return peaks.empty() ? 0 : std::abs(peaks[0].position - highest.position);
}

/// The same, judged with the second looks that there are.
Focus judged(Focus focus, const SearchTrace& trace, const FocusLimits& limits,
             const Scatter& scatter) {
  const FocusCurve curve = trace.curve();
  focus.second_looks = trace.second_looks();
  const SecondLooks looks = compare_looks(focus.second_looks, curve, focus.lobes[0], scatter);
  Peak& highest = focus.lobes[0];
  const double saturated = curve.top().picture.saturated;
  const double light = shift_of_light(trace, highest, scatter);
  highest.sigma = std::hypot(std::hypot(highest.sigma, looks.shift, focus.depths.spread),
                             saturation_sigma(saturated, highest.half_width), light);
  focus.verdict = judge(curve, trace.raw_curve(), focus.lobes, scatter,
                        {.looks = looks,
                         .depths = focus.depths,
                         .is_live = limits.is_live,
                         .saturated = saturated,
                         .light = part_light_of(trace.known(), scatter.of_parts()),
                         .light_shift = light});
  Reason& reason = focus.verdict.reason;
  reason.is_live = limits.is_live;
  reason.at_lens_end = reason.why == Why::at_end &&
                       (reason.position <= limits.lowest || reason.position >= limits.highest);
  reason.whole_travel = limits.from <= limits.lowest && limits.to >= limits.highest;
  reason.largest_window = limits.largest_window;
  focus.peak = answer_of(focus, curve, limits);
  heed_spectra(focus, trace.first(), limits);
  return focus;
}

}  // namespace

Focus judge_search(const SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter,
                   std::optional<SpectralEnd> spectral_end) {
  return judged(shape_of(trace, limits, scatter, spectral_end), trace, limits, scatter);
}

namespace {

/// A focus that the curve of this shape tells, after second looks at it.
Focus looked_again(const Focus& shape, Focus focus, SearchTrace& trace, const FocusLimits& limits,
                   const Scatter& scatter) {
  if (!limits.is_live || focus.result() != FocusResult::focused) return focus;
  look_again(trace, focus.lobes[0]);
  if (limits.returns) trace.look_again(limits.start);
  return judged(shape, trace, limits, scatter);
}

}  // namespace

Focus conclude_search(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter,
                      std::optional<SpectralEnd> spectral_end) {
  const Focus shape = shape_of(trace, limits, scatter, spectral_end);
  return looked_again(shape, judged(shape, trace, limits, scatter), trace, limits, scatter);
}

namespace {

/// By scores, from what is known already.
Focus searched(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter,
               std::optional<SpectralEnd> spectral_end) {
  search_of(limits.search).run(trace, limits, scatter);
  return conclude_search(trace, limits, scatter, spectral_end);
}

/// By scores, where spectra have not led to the focus; but once the lens has been near it, they may
/// tell it where scores drown in noise.
Focus searched_after(SpectralEnd end, SearchTrace& trace, const FocusLimits& limits,
                     const Scatter& scatter) {
  Focus focus = searched(trace, limits, scatter, end);
  const bool is_drowned =
      focus.result() == FocusResult::no_focus && is_for_noise(focus.verdict.reason.why);
  if (!is_drowned || end == SpectralEnd::no_spectra ||
      !pass_by_spectra(trace, limits, focus.lobes[0].position))
    return focus;
  return conclude_search(trace, limits, scatter, SpectralEnd::found);
}

}  // namespace

Focus search_focus(const Objective& objective, const FocusLimits& limits, const MetricSpec& spec,
                   double repeat_scatter) {
  const Scatter scatter(spec, repeat_scatter);
  SearchTrace trace(objective, scatter.light);
  if (limits.most_pictures > 0) return budget_search(trace, limits, scatter);
  if (limits.search == SearchMethod::spectral && !limits.blur)
    return joint_search(trace, limits, scatter);
  if (!limits.blur) return searched(trace, limits, scatter, {});
  const SpectralEnd end = spectral_search(trace, limits);
  // An object with relief defocuses as no plane does; its peak may have been passed all the same.
  const bool may_have_passed = end == SpectralEnd::found || end == SpectralEnd::does_not_defocus;
  if (may_have_passed) {
    const Focus shape = shape_of(trace, limits, scatter, end);
    Focus focus = judged(shape, trace, limits, scatter);
    // A shape with as many parameters as points goes through anything.
    const bool is_passed = end == SpectralEnd::found || focus.peak.is_judged();
    if (is_passed && focus.result() == FocusResult::focused)
      return looked_again(shape, std::move(focus), trace, limits, scatter);
  }
  // Where play is not taken up, or the scene moved, the pictures of a peak that was passed contradict
  // those of any other search; pictures that are all alike crowd its curve and tell it nothing.
  const bool is_misleading = end == SpectralEnd::found || end == SpectralEnd::nothing_changes;
  if (!is_misleading) return searched_after(end, trace, limits, scatter);
  SearchTrace anew(objective, scatter.light);
  if (const Evaluation* const first = trace.first()) anew.began_with(*first);
  return searched_after(end == SpectralEnd::found ? SpectralEnd::lost : end, anew, limits, scatter);
}

double saturation_sigma(double saturated, double half_width) {
  // A part of the width that `fathom_honesty --kind overexposed` asks for, all of it from a quarter
  // of the pixels on.
  constexpr double kMost = 0.02, kAll = 0.25;
  return kMost * half_width * std::min(1.0, saturated / kAll);
}

void doubt_for_losses(Focus& focus, double lost_part) {
  const double kept = 1 - std::clamp(lost_part, 0.0, 0.99);
  focus.lost_part = lost_part;
  focus.verdict.confidence *= kept;
  focus.peak.sigma /= std::sqrt(kept);
}

namespace {

/// What some hundred positions have between them.
double usual_step(const LensInfo& lens, double from, double to) {
  constexpr double kIntervals = 100;
  return std::max(1.0, std::ceil((to - from) / kIntervals / lens.resolution)) * lens.resolution;
}

}  // namespace

std::vector<double> sweep_positions(const LensInfo& lens, double from, double to,
                                    std::optional<double> wanted_step) {
  if (!wanted_step && !lens.stops.empty()) return stops_between(lens, from, to);
  const double step = wanted_step ? *wanted_step : usual_step(lens, from, to);
  if (!(step > 0 && std::isfinite(step))) {
    throw Error(
        ErrorCode::bad_argument,
        fmt::format("a sweep by steps of {} goes nowhere; a step must be a number above 0", step));
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
