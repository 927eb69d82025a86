// SPDX-License-Identifier: Apache-2.0
#include "focus/spectral_budget.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <vector>

#include "focus/spectral_side.hpp"
#include "focus/spectral_verdict.hpp"

namespace fathom {
namespace {

constexpr double kBudgetHopPx = 3;  ///< The first hop: the side from little travel.
constexpr double kBeyondPx = 5;     ///< So far beyond the focus that is foretold.

/// Where the next picture tells most. Well beyond the focus first: what the law and the blur do not
/// know of a picture shifts it one way, and of one on the other side the other way. In the focus a
/// picture tells least, for its fine rings are in no other one. While nobody knows the focus, a stride
/// towards what is sharper.
double next_place(const SearchTrace& trace, const SpectralFit& fit, double here, int direction,
                  const FocusLimits& limits) {
  const BlurModel& model = *limits.blur;
  if (!is_sure(fit)) {
    const int side = sharper_side(trace.evaluations(), ring_sides(trace.evaluations()).largest);
    const double way = side == 0 ? direction : side;
    const Neighbours sharpest =
        around_sharpest(trace.evaluations(), ring_sides(trace.evaluations()).largest);
    const double from = way > 0 ? sharpest.high->position : sharpest.low->position;
    return from + way * model.units(kStridePx);
  }
  const int way = fit.position >= here ? 1 : -1;
  for (const double px : {kBeyondPx, 2.0, -2.0, 1.0, -1.0, 0.0}) {
    const double place = fit.position + way * model.units(px);
    const bool is_new = std::none_of(
        trace.evaluations().begin(), trace.evaluations().end(),
        [&](const Evaluation& e) { return std::abs(e.position - place) < model.units(kCloserPx); });
    if (is_new && place >= limits.from && place <= limits.to) return place;
  }
  return fit.position;
}

/// What all pictures say, and what all but the last one said.
struct Fits {
  SpectralFit before, now;
};

Fits look_around(SearchTrace& trace, const FocusLimits& limits) {
  const auto look = [&](double wanted) {
    const double inside = std::clamp(wanted, limits.from, limits.to);
    trace.score_at(inside);
    return trace.nearest(inside);
  };
  double here = look(limits.start);
  const int direction = limits.to - here >= here - limits.from ? 1 : -1;
  here = look(here + direction * limits.blur->units(kBudgetHopPx));
  Fits fits{.before = {}, .now = fit_all(trace.evaluations(), here, limits)};
  for (int pictures = 2; pictures < limits.most_pictures; ++pictures) {
    if (ring_sides(trace.evaluations()).largest == 0 || trace.evaluations().size() < 2) return {};
    const double next = next_place(trace, fits.now, here, direction, limits);
    const auto before = trace.evaluations().size();
    here = look(next);
    if (trace.evaluations().size() == before) break;  // the lens has no other place there
    fits = {.before = fits.now, .now = fit_all(trace.evaluations(), here, limits)};
  }
  return fits;
}

/// Far from the focus any pictures fit one nearby that is not there; it is elsewhere after the next
/// picture. A true one stays. One that lies between two pictures alike is not sure before the third,
/// for a lens that changes nothing makes such, too.
bool has_stayed(const Fits& fits, std::span<const Evaluation> evaluations, const BlurModel& model) {
  constexpr double kSigmas = 3, kApartPx = 1, kUpClosePx = 2;
  const auto before = evaluations.first(evaluations.size() - 1);
  const bool is_up_close = std::any_of(before.begin(), before.end(), [&](const Evaluation& e) {
    return std::abs(e.position - fits.now.position) < model.units(kUpClosePx);
  });
  return (is_sure(fits.before) || is_up_close) && is_sure(fits.now) &&
         std::abs(fits.before.position - fits.now.position) <
             kSigmas * std::hypot(fits.before.sigma, fits.now.sigma) + model.units(kApartPx);
}

/// Whether the pictures are likelier, by more than chance, of a lens that blurs faster or slower than
/// was said. With a wrong blur so few pictures fit a focus that is not there.
bool is_of_another_lens(const SpectralFit& fit, std::span<const Evaluation> evaluations,
                        const FocusLimits& limits) {
  // The right blur stays below in 98 of 100 (fathom_spectral --frames 3 --within 200).
  constexpr double kChance = 8;
  constexpr double kFactors[] = {0.5, 0.7, 1.4, 2};
  const auto likelihood_of = [](const SpectralFit& one) {
    return one.evidence * std::max(1.0, one.misfit);
  };
  const double wing = limits.blur->units(fit.side / 4.0);
  const std::vector<Evaluation> pictures = near(evaluations, fit.position, wing);
  const SpectralRange range{std::max(limits.from, fit.position - wing),
                            std::min(limits.to, fit.position + wing)};
  const double told = likelihood_of(fit_spectra(pictures, fit.side, *limits.blur, range));
  const double scale = std::max(1.0, fit.misfit);
  return std::any_of(std::begin(kFactors), std::end(kFactors), [&](double factor) {
    BlurModel other = *limits.blur;
    other.px_per_unit *= factor;
    return likelihood_of(fit_spectra(pictures, fit.side, other, range)) - told > kChance * scale;
  });
}

/// With a part of what the last picture moved it by: as measured on the simulated rig.
double sigma_of(const Fits& fits) {
  constexpr double kMoved = 0.14;
  return std::hypot(doubted(fits.now).sigma, kMoved * (fits.now.position - fits.before.position));
}

}  // namespace

Focus budget_search(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter) {
  const Fits fits = look_around(trace, limits);
  const SpectralFit& fit = fits.now;
  Focus focus = judge_search(trace, limits, scatter);
  if (fit.side != 0) focus.spectral = doubted(fit);
  Verdict& verdict = focus.verdict;
  const bool is_inside = fit.position >= limits.from && fit.position <= limits.to;
  const bool seems_found = has_stayed(fits, trace.evaluations(), *limits.blur) && is_inside &&
                           is_possible(focus.evaluations, fit.position, *limits.blur);
  const bool is_of_another = seems_found && is_of_another_lens(fit, trace.evaluations(), limits);
  const bool is_found = seems_found && !is_of_another;
  focus.spectral_end = is_of_another ? SpectralEnd::does_not_defocus
                       : is_found    ? SpectralEnd::found
                                     : SpectralEnd::lost;
  verdict.confidence = is_found ? confidence_of(fit) : 0;
  verdict.result = is_found ? FocusResult::focused : FocusResult::no_focus;
  verdict.reason.why = is_found ? Why::by_spectra : Why::too_few_frames;
  verdict.reason.position = fit.position;
  if (!is_found) return focus;
  focus.peak = {.position = fit.position,
                .sigma = sigma_of(fits),
                .score = best_of(focus.evaluations).score,
                .points = fit.pictures};
  focus.lobes = {focus.peak};
  return focus;
}

}  // namespace fathom
