// SPDX-License-Identifier: Apache-2.0
#include "focus/spectral.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "focus/noise.hpp"
#include "focus/spectral_likelihood.hpp"

namespace fathom {
namespace {

/// Costs over places of the focus, a pixel of blur apart.
struct Profile {
  double low = 0, step = 1;
  std::vector<double> costs;

  double position(std::size_t i) const { return low + step * static_cast<double>(i); }
  std::size_t best() const {
    return static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  }
};

Profile profile_of(const SpectralLikelihood& likelihood, const BlurModel& model,
                   const SpectralRange& range) {
  constexpr double kStepPx = 1, kMost = 2000;
  constexpr int kRoughly =
      2;  // rounds: beyond, costs change by little beside what tells places apart
  Profile profile;
  profile.low = range.low;
  profile.step = std::max(model.units(kStepPx), (range.high - range.low) / kMost);
  const int intervals = static_cast<int>(std::ceil((range.high - range.low) / profile.step));
  for (int i = 0; i <= intervals; ++i)
    profile.costs.push_back(likelihood.at(profile.position(i), kRoughly).total);
  return profile;
}

/// The next best place beyond a ridge from the best one.
void find_second(SpectralFit& fit, const Profile& profile, double best_cost, double scale) {
  fit.second_worse = kBoundless;
  const std::size_t best = profile.best();
  for (const int side : {-1, 1}) {
    double ridge = profile.costs[best];
    for (auto i = static_cast<std::ptrdiff_t>(best) + side;
         i >= 0 && i < static_cast<std::ptrdiff_t>(profile.costs.size()); i += side) {
      ridge = std::max(ridge, profile.costs[i]);
      constexpr double kRidge = 2;  // between two places, else they are one
      const double worse = (profile.costs[i] - best_cost) / 2 / scale;
      if (profile.costs[i] > ridge - kRidge * scale || worse >= fit.second_worse) continue;
      fit.second_worse = worse;
      fit.second_position = profile.position(i);
    }
  }
}

/// How uncertain the answer is for the places of pictures that were taken on the way. Play that nobody
/// knows misplaces all of them alike. Those near the focus, least blurred, tell most.
double sigma_of_places(const SpectralLikelihood& likelihood, const BlurModel& model,
                       double answer) {
  double sum = 0, weights = 0;
  for (const RingPicture& picture : likelihood.pictures()) {
    const double blur_px = model.diameter_px(picture.position - answer);
    sum += picture.way.sigma / (blur_px * blur_px);
    weights += 1 / (blur_px * blur_px);
  }
  return sum / weights;
}

/// How far the answer moves if the model's blur is another within what is not known of it.
double unknown_of_model(const SpectralLikelihood& likelihood, const BlurModel& model,
                        const LeastCost& answer, bool is_between) {
  constexpr int kShiftRounds = 2;  // a shift need not be known better
  BlurModel faster = model;
  faster.px_per_unit *= 1 + model.uncertainty;
  const double step = std::max(answer.sigma, model.units(0.05));
  const double shift =
      least_cost_near(likelihood.with(faster), answer.position, step, kShiftRounds).position -
      answer.position;
  const double aside = sigma_of_places(likelihood, model, answer.position);
  // Of the law itself, as measured (docs/spectral.md): beside the nearest picture, and where that is
  // blurred by a part of the window, for light comes in from outside.
  // On both sides of the focus it pulls both ways.
  constexpr double kBiasPx = 0.08, kBiasBetweenPx = 0.06, kFarBias = 0.12;
  const double bias_px = is_between ? kBiasBetweenPx : kBiasPx;
  double nearest = std::numeric_limits<double>::infinity();
  for (const RingPicture& picture : likelihood.pictures())
    nearest = std::min(nearest, std::abs(picture.position - answer.position));
  const double far = model.px_per_unit * nearest / (likelihood.side() / 4.0);
  return std::hypot(std::hypot(shift, aside), model.units(bias_px), kFarBias * far * far * nearest);
}

}  // namespace

SpectralFit fit_spectra(std::span<const Evaluation> evaluations, int side, const BlurModel& model,
                        const SpectralRange& range) {
  require_valid(model);
  SpectralFit fit;
  if (rings_of_side(side) == 0) return fit;
  const SpectralLikelihood likelihood(evaluations, side, model);
  const auto [lowest, highest] = std::minmax_element(
      likelihood.pictures().begin(), likelihood.pictures().end(),
      [](const RingPicture& a, const RingPicture& b) { return a.position < b.position; });
  if (likelihood.size() < 2 || lowest->position == highest->position) return fit;
  const Profile profile = profile_of(likelihood, model, range);
  const LeastCost best =
      least_cost_near(likelihood, profile.position(profile.best()), profile.step / 2);
  const SpectralLikelihood::Cost cost = likelihood.at(best.position);
  fit.side = side;
  fit.pictures = static_cast<int>(likelihood.size());
  fit.position = best.position;
  fit.misfit = cost.chi_squared / likelihood.freedom();
  const double scale = std::max(1.0, fit.misfit);
  // Rings of one picture, and errors of the law, are not as independent as the cost takes them; from
  // one side alone they all pull one way. As measured (docs/spectral.md).
  const bool is_between = lowest->position < best.position && best.position < highest->position;
  const double together = is_between ? 1.3 : 2.5;
  fit.sigma = std::hypot(together * best.sigma * std::sqrt(scale),
                         unknown_of_model(likelihood, model, best, is_between));
  fit.evidence = (likelihood.unchanged().total - cost.total) / 2 / scale;
  find_second(fit, profile, cost.total, scale);
  return fit;
}

RingSides ring_sides(std::span<const Evaluation> evaluations) {
  RingSides sides;
  if (evaluations.empty()) return sides;
  for (const RingPowers& rings : evaluations[0].picture.rings) {
    const bool all = std::all_of(evaluations.begin(), evaluations.end(), [&](const Evaluation& e) {
      return rings_in(e.picture, rings.side) != nullptr;
    });
    if (!all) continue;
    if (sides.smallest == 0) sides.smallest = rings.side;
    sides.largest = rings.side;
  }
  return sides;
}

namespace {

/// Those up to some nine cycles a window.
int coarse_rings(const DefocusLaw& law) {
  const double cycles_per_ring = law.side() / 2.0 / law.rings();
  return std::clamp(static_cast<int>(9 / cycles_per_ring), 1, law.rings());
}

}  // namespace

double most_coarse_change(double first_from_focus, double second_from_focus, int side,
                          const BlurModel& model) {
  const DefocusLaw& law = DefocusLaw::of(side, model.shape);
  std::vector<float> first(law.rings()), second(law.rings()), slope(law.rings());
  law.transfer(model.diameter_px(first_from_focus), first, slope);
  law.transfer(model.diameter_px(second_from_focus), second, slope);
  const int finest = coarse_rings(law) - 1;
  constexpr float kLeast = 1e-3F;
  return std::log(std::max(second[finest], kLeast) / std::max(first[finest], kLeast));
}

CoarseChange coarse_change(const Evaluation& first, const Evaluation& second, int side) {
  const Evaluation both[] = {first, second};
  const SpectralLikelihood likelihood(both, side, {.px_per_unit = 1});
  if (likelihood.size() < 2) return {};
  const DefocusLaw& law = DefocusLaw::of(side, BlurShape::disc);
  const int rings = coarse_rings(law);
  double sums[2] = {}, variance[2] = {};
  for (int i = 0; i < 2; ++i) {
    const RingPicture& picture = likelihood.pictures()[i];
    for (int k = 0; k < rings; ++k) {
      const double count = law.counts()[k], signal = std::max(0.0, picture.powers[k] - 1.0);
      sums[i] += count * signal;
      variance[i] += count * (1 + 2 * signal) * 2 / kRingFreedom;
    }
  }
  constexpr double kLeast = 1e-12;
  CoarseChange change;
  change.part = std::log(std::max(sums[1], kLeast) / std::max(sums[0], kLeast));
  change.sigma = std::sqrt(variance[0] / std::max(sums[0] * sums[0], kLeast) +
                           variance[1] / std::max(sums[1] * sums[1], kLeast));
  return change;
}

}  // namespace fathom
