// SPDX-License-Identifier: Apache-2.0
#include "focus/spectral_fits.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "focus/focus.hpp"
#include "focus/spectral_side.hpp"

namespace fathom {
namespace {

constexpr double kLeastLead = 6;

/// The law is believed so far from a picture: a part of the distance where blur fills a quarter of
/// the window.
constexpr double kReach = 0.75;

double reach_of(int side, const BlurModel& model) { return kReach * model.units(side / 4.0); }

double from_nearest(std::span<const Evaluation> evaluations, double position) {
  double least = kBoundless;
  for (const Evaluation& e : evaluations) least = std::min(least, std::abs(e.position - position));
  return least;
}

/// The fit of the pictures within the law's reach of `here`, and then of those round what that gives.
SpectralFit fit_near(std::span<const Evaluation> evaluations, int side, double here,
                     const FocusLimits& limits) {
  const BlurModel& model = *limits.blur;
  const double quarter = model.units(side / 4.0), beyond = model.units(kWingPx);
  constexpr double kWide = 1.25;
  std::vector<Evaluation> chosen = near(evaluations, here, kWide * quarter);
  if (chosen.empty()) return {};
  // Farther from every picture than this the law is not believed anyway.
  const auto [lowest, highest] = std::minmax_element(
      chosen.begin(), chosen.end(),
      [](const Evaluation& a, const Evaluation& b) { return a.position < b.position; });
  const SpectralRange range{std::max(limits.from - beyond, lowest->position - quarter),
                            std::min(limits.to + beyond, highest->position + quarter)};
  SpectralFit fit = fit_spectra(chosen, side, model, range);
  if (fit.side == 0) return fit;
  std::vector<Evaluation> closer = near(evaluations, fit.position, quarter);
  if (closer.size() >= 3 && closer.size() != chosen.size()) {
    const SpectralFit again = fit_spectra(closer, side, model, range);
    if (again.side != 0) {
      fit = again;
      chosen = std::move(closer);
    }
  }
  if (from_nearest(chosen, fit.position) >= reach_of(side, model))
    fit.second_worse = 0;  // out there the law is no law
  return fit;
}

/// A sure fit of the narrow window, held against that of the wide one. Light from outside takes part
/// in each in another way: a false focus is at another place in each, and no focus is sure then.
SpectralFit of_both(const SpectralFit& narrow, const SpectralFit& wide, const BlurModel& model) {
  constexpr double kSigmas = 3, kApartPx = 1, kOfDifference = 0.5;
  const double apart = std::abs(narrow.position - wide.position);
  SpectralFit fit = is_sure(wide) && wide.sigma < narrow.sigma ? wide : narrow;
  if (wide.side == 0 || wide.misfit > kWorstMisfit) return narrow;
  if (apart > kSigmas * std::hypot(narrow.sigma, wide.sigma) + model.units(kApartPx)) {
    fit = wide;
    fit.second_position = narrow.position;
    fit.second_worse = 0;
  }
  fit.sigma = std::hypot(fit.sigma, kOfDifference * apart);
  return fit;
}

}  // namespace

double confidence_of(const SpectralFit& fit) {
  if (!is_sure(fit)) return 0;
  return (1 - kLeastEvidence / fit.evidence) * (1 - kLeastLead / fit.second_worse) /
         std::max(1.0, fit.misfit);
}

bool is_sure(const SpectralFit& fit) {
  return fit.side != 0 && fit.evidence > kLeastEvidence && fit.second_worse > kLeastLead &&
         fit.misfit < kWorstMisfit;
}

SpectralFit fit_all(std::span<const Evaluation> evaluations, double here,
                    const FocusLimits& limits) {
  const RingSides sides = ring_sides(evaluations);
  if (sides.largest == 0) return {};
  const SpectralFit narrow = fit_near(evaluations, sides.smallest, here, limits);
  if (sides.smallest == sides.largest) return narrow;
  const double near = limits.blur->units(sides.smallest / 32.0);
  if (is_sure(narrow) && from_nearest(evaluations, narrow.position) < near) return narrow;
  // From afar the wide window knows more, for less of its light comes from outside.
  const SpectralFit wide = fit_near(evaluations, sides.largest, here, limits);
  return is_sure(narrow) ? of_both(narrow, wide, *limits.blur) : wide;
}

}  // namespace fathom
