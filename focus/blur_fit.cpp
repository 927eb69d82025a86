// SPDX-License-Identifier: Apache-2.0
#include "focus/blur_fit.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "focus/noise.hpp"
#include "focus/spectral.hpp"
#include "focus/spectral_likelihood.hpp"

namespace fathom {
namespace {

constexpr std::size_t kLeastPictures = 4;
constexpr std::size_t kMostPictures = 40;  ///< More tell little, and cost time.
constexpr double kGridRatio = 1.15;        ///< Between two kappas that are tried.
/// Blur of the farthest picture: below, a lens cannot be told from a still one.
constexpr double kLeastBlurPx = 2;
constexpr double kLargestUncertainty = 0.3;
/// So far the law is fitted in the end: blur as a part of the window.
constexpr double kNear = 0.1;

using Pictures = std::vector<Evaluation>;

/// In the order of positions; those without rings of this side are left out.
Pictures with_rings(std::span<const Evaluation> evaluations, int side) {
  Pictures chosen;
  for (const Evaluation& e : evaluations) {
    if (rings_in(e.picture, side) != nullptr) chosen.push_back(e);
  }
  std::sort(chosen.begin(), chosen.end(),
            [](const Evaluation& a, const Evaluation& b) { return a.position < b.position; });
  return chosen;
}

/// At most kMostPictures: the nearest to a focus, and evenly some of the
/// others.
Pictures thinned(Pictures pictures, double focus) {
  constexpr std::size_t kNearest = kMostPictures / 2;
  if (pictures.size() <= kMostPictures) return pictures;
  std::stable_sort(pictures.begin(), pictures.end(), [&](const Evaluation& a, const Evaluation& b) {
    return std::abs(a.position - focus) < std::abs(b.position - focus);
  });
  const std::size_t others = pictures.size() - kNearest;
  const std::size_t stride = (others + kNearest - 1) / kNearest;
  Pictures chosen(pictures.begin(), pictures.begin() + kNearest);
  for (std::size_t i = kNearest; i < pictures.size(); i += stride) chosen.push_back(pictures[i]);
  return chosen;
}

/// Without a focus to be near to.
Pictures thinned(const Pictures& pictures) {
  const std::size_t stride = (pictures.size() + kMostPictures - 1) / kMostPictures;
  Pictures chosen;
  for (std::size_t i = 0; i < pictures.size(); i += std::max<std::size_t>(stride, 1))
    chosen.push_back(pictures[i]);
  return chosen;
}

Pictures within(const Pictures& pictures, double focus, double distance) {
  Pictures chosen;
  for (const Evaluation& e : pictures) {
    if (std::abs(e.position - focus) <= distance) chosen.push_back(e);
  }
  return chosen;
}

/// Places to look for a focus: the pictures' own and those halfway between two.
std::vector<double> places_among(const Pictures& pictures) {
  std::vector<double> places;
  for (const Evaluation& e : pictures) {
    if (!places.empty() && e.position > places.back())
      places.push_back((places.back() + e.position) / 2);
    if (places.empty() || e.position > places.back()) places.push_back(e.position);
  }
  return places;
}

/// Distance of the third picture from a place: so many at least must be blurred
/// by less than a quarter of the window.
double third_distance(const Pictures& pictures, double place) {
  std::vector<double> distances;
  for (const Evaluation& e : pictures) distances.push_back(std::abs(e.position - place));
  std::nth_element(distances.begin(), distances.begin() + 2, distances.end());
  return distances[2];
}

double farthest_of(const Pictures& pictures, double place) {
  double farthest = 0;
  for (const Evaluation& e : pictures) farthest = std::max(farthest, std::abs(e.position - place));
  return farthest;
}

/// A model with the place of the focus that suits it best.
struct Candidate {
  BlurModel model;
  double position = 0;
  double cost = kBoundless;
};

/// The search for the least cost over kappa, rest and shape, the focus
/// following.
class Descent {
 public:
  explicit Descent(const SpectralLikelihood& likelihood) : likelihood_(likelihood) {}

  Candidate at(const BlurModel& model, double place) const {
    const LeastCost least =
        least_cost_near(likelihood_.with(model), place, model.units(kFirstStepPx));
    return {model, least.position, least.cost};
  }

  /// The best of every few kappas of a grid, each from the best of these places.
  std::vector<Candidate> over_grid(double low, double high,
                                   const std::vector<double>& places) const {
    constexpr int kFew = 4;
    std::vector<Candidate> found;
    int count = 0;
    for (double kappa = low; kappa <= high * kGridRatio; kappa *= kGridRatio) {
      BlurModel model;
      model.px_per_unit = kappa;
      const Candidate now = at(model, best_place(model, places));
      if (count++ % kFew == 0) found.emplace_back();
      if (now.cost < found.back().cost) found.back() = now;
    }
    return found;
  }

  /// Goes on from a candidate until neither kappa nor rest makes it better.
  Candidate refined(Candidate best) const {
    best = at(best.model, best.position);
    constexpr int kRounds = 6;
    for (int round = 0; round < kRounds; ++round) {
      const double before = best.cost;
      best = along(best, &BlurModel::px_per_unit, std::pow(kGridRatio, std::pow(0.5, round)));
      best = along(best, &BlurModel::rest_px, 1 + std::pow(0.6, round));
      if (round > 2 && before - best.cost < 0.05) break;
    }
    return best;
  }

  /// Standard uncertainty of ln kappa, by the cost's curvature.
  double uncertainty(const Candidate& best) const {
    for (const double step : {1.05, 1.15}) {
      const double ln = std::log(step);
      const double bend = scaled(best, step).cost - 2 * best.cost + scaled(best, 1 / step).cost;
      if (bend > 0) return ln * std::sqrt(2 / bend);
    }
    return kBoundless;
  }

 private:
  static constexpr double kFirstStepPx = 0.5;

  double best_place(const BlurModel& model, const std::vector<double>& places) const {
    if (places.size() == 1) return places[0];
    const SpectralLikelihood likelihood = likelihood_.with(model);
    double best = places[0], least = kBoundless;
    for (const double place : places) {
      const double cost = likelihood.at(place).total;
      if (cost >= least) continue;
      least = cost;
      best = place;
    }
    return best;
  }

  Candidate scaled(const Candidate& from, double by) const {
    BlurModel model = from.model;
    model.px_per_unit *= by;
    return at(model, from.position);
  }

  /// Multiplies or divides one number of the model for as long as that helps.
  Candidate along(Candidate best, double BlurModel::*number, double by) const {
    constexpr int kMostSteps = 12;
    constexpr double kLeastRest = 0.3, kMostRest = 8;
    for (const double factor : {by, 1 / by}) {
      bool helped = false;
      for (int step = 0; step < kMostSteps; ++step) {
        BlurModel model = best.model;
        model.*number *= factor;
        if (model.rest_px < kLeastRest || model.rest_px > kMostRest) break;
        const Candidate next = at(model, best.position);
        if (!(next.cost < best.cost)) break;
        best = next;
        helped = true;
      }
      if (helped) break;
    }
    return best;
  }

  const SpectralLikelihood& likelihood_;
};

Candidate with_shape(Candidate from, BlurShape shape) {
  from.model.shape = shape;
  return from;
}

bool has_both_sides(const Pictures& pictures, double focus, int a_side) {
  std::vector<double> below, above;
  for (const Evaluation& e : pictures) (e.position < focus ? below : above).push_back(e.position);
  const auto different = [](std::vector<double>& positions) {
    return std::unique(positions.begin(), positions.end()) - positions.begin();
  };
  std::sort(below.begin(), below.end());
  std::sort(above.begin(), above.end());
  return different(below) >= a_side && different(above) >= a_side;
}

/// Whether the coarsest rings are alike below and above the focus. Where they go on rising, the focus
/// is elsewhere: far from it any pictures fit a false one nearby (docs/spectral.md).
bool is_turning(const Pictures& pictures, const BlurFit& fit, int side) {
  const auto below = [&](const Evaluation& e) { return fit.position - e.position; };
  const Evaluation& low = *std::max_element(
      pictures.begin(), pictures.end(),
      [&](const Evaluation& a, const Evaluation& b) { return below(a) < below(b); });
  const auto apart = [&](const Evaluation& e) { return std::abs(below(e) + below(low)); };
  const Evaluation& high = *std::min_element(
      pictures.begin(), pictures.end(),
      [&](const Evaluation& a, const Evaluation& b) { return apart(a) < apart(b); });
  constexpr double kSigmas = 5, kAlike = 0.15, kAlikePerPx = 0.25;
  const CoarseChange change = coarse_change(low, high, side);
  const double aside_px = fit.model.px_per_unit * apart(high);
  return std::abs(change.part) < std::max(kSigmas * change.sigma, kAlike + kAlikePerPx * aside_px);
}

/// Power above the noise in the rings that a blur of a quarter of the window leaves nothing of, [i] of
/// picture i.
std::vector<double> fine_powers(const Pictures& pictures, int side) {
  const SpectralLikelihood likelihood(pictures, side, {.px_per_unit = 1});
  const DefocusLaw& law = DefocusLaw::of(side, BlurShape::disc);
  std::vector<double> sums;
  for (const RingPicture& picture : likelihood.pictures()) {
    double sum = 0;
    for (int k = law.rings() / 4; k < law.rings(); ++k)
      sum += law.counts()[k] * (picture.powers[k] - 1.0);
    sums.push_back(sum);
  }
  return sums;
}

/// Whether some picture is too sharp for the blur that the model gives it, half the window or more. A
/// few pictures that hardly differ fit any fast blur, and only those beyond its reach tell.
bool is_outshone(const Pictures& all, int side, const BlurFit& fit) {
  constexpr double kLost = 0.5, kLeft = 0.25;
  const std::vector<double> fine = fine_powers(all, side);
  double within = 0, beyond = 0;
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const double blur = fit.model.diameter_px(all[i].position - fit.position);
    double& most = blur < kLost * side ? within : beyond;
    most = std::max(most, fine[i]);
  }
  return beyond > kLeft * within;
}

/// What a candidate is worth, or nothing.
std::optional<BlurFit> judged(const SpectralLikelihood& likelihood, const Candidate& best,
                              const Pictures& pictures) {
  const SpectralLikelihood there = likelihood.with(best.model);
  const SpectralLikelihood::Cost cost = there.at(best.position);
  BlurFit fit;
  fit.model = best.model;
  fit.position = best.position;
  fit.pictures = static_cast<int>(pictures.size());
  fit.farthest = farthest_of(pictures, best.position);
  fit.misfit = cost.chi_squared / there.freedom();
  const double scale = std::max(1.0, fit.misfit);
  fit.evidence = (there.unchanged().total - cost.total) / 2 / scale;
  // As the errors of the rings of one picture are alike (spectral.cpp), and
  // with what the law itself is worth.
  constexpr double kTogether = 1.3, kOfTheLaw = 0.03;
  fit.model.uncertainty =
      std::hypot(kTogether * std::sqrt(scale) * Descent(likelihood).uncertainty(best), kOfTheLaw);
  const bool is_told =
      fit.model.uncertainty < kLargestUncertainty &&
      fit.model.px_per_unit * fit.farthest > std::max(kLeastBlurPx, fit.model.rest_px);
  if (!is_told || fit.evidence < kLeastEvidence || fit.misfit > kWorstMisfit ||
      !is_turning(pictures, fit, likelihood.side()))
    return std::nullopt;
  return fit;
}

Candidate best_of_shapes(const SpectralLikelihood& likelihood, const Candidate& from) {
  const Descent descent(likelihood);
  const Candidate disc = descent.refined(with_shape(from, BlurShape::disc));
  const Candidate gaussian = descent.refined(with_shape(from, BlurShape::gaussian));
  constexpr double kChance = 10;
  return gaussian.cost < disc.cost - kChance ? gaussian : disc;
}

/// Fits where the law holds for the kappa that is known by then: at first as
/// far as blur fills a quarter of the window, then, where enough pictures are
/// left, a tenth. Shading carries light in from farther away than texture does.
std::optional<BlurFit> fit_within(const Pictures& all, int side, Candidate best, int a_side) {
  constexpr int kRounds = 5;
  constexpr double kFirst = 0.25, kSettled = 0.02;
  Pictures used;
  for (int round = 0; round < kRounds; ++round) {
    const double reach = (round == 0 ? kFirst : kNear) * side;
    Pictures near = thinned(within(all, best.position, best.model.units(reach)), best.position);
    if (near.size() < kLeastPictures || !has_both_sides(near, best.position, a_side)) break;
    used = std::move(near);
    const double before = best.model.px_per_unit;
    best = best_of_shapes(SpectralLikelihood(used, side, best.model), best);
    if (round > 1 && std::abs(best.model.px_per_unit / before - 1) < kSettled) break;
  }
  if (used.empty() || !has_both_sides(used, best.position, a_side)) return std::nullopt;
  const auto fit = judged(SpectralLikelihood(used, side, best.model), best, used);
  return fit && is_outshone(all, side, *fit) ? std::nullopt : fit;
}

/// The fit from several starts, of which shading may mislead one: the first that describes the
/// pictures well, else the one that does so best.
std::optional<BlurFit> best_fit(const Pictures& all, int side, int a_side,
                                std::vector<Candidate> starts) {
  constexpr double kGood = 1.15;
  std::sort(starts.begin(), starts.end(),
            [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  std::optional<BlurFit> best;
  for (const Candidate& start : starts) {
    const auto fit = fit_within(all, side, start, a_side);
    if (fit && (!best || fit->misfit < best->misfit)) best = fit;
    if (best && best->misfit < kGood) break;
  }
  return best;
}

std::optional<BlurFit> fit_side(const Pictures& all, int side, const BlurFitOptions& options) {
  if (all.size() < kLeastPictures || all.front().position == all.back().position)
    return std::nullopt;
  const Pictures coarse = options.focus ? thinned(all, *options.focus) : thinned(all);
  const std::vector<double> places =
      options.focus ? std::vector<double>{*options.focus} : places_among(coarse);
  const double span = all.back().position - all.front().position;
  double nearest = kBoundless;
  for (const double place : places) nearest = std::min(nearest, third_distance(coarse, place));
  if (!(nearest > 0)) return std::nullopt;
  return best_fit(all, side, options.a_side,
                  Descent(SpectralLikelihood(coarse, side, {.px_per_unit = 1}))
                      .over_grid(kLeastBlurPx / span, kNear * side / nearest, places));
}

}  // namespace

std::optional<BlurFit> fit_blur(std::span<const Evaluation> evaluations,
                                const BlurFitOptions& options) {
  const RingSides sides = ring_sides(evaluations);
  for (const int side : {sides.smallest, sides.largest}) {
    if (side == 0) return std::nullopt;
    if (const auto fit = fit_side(with_rings(evaluations, side), side, options)) return fit;
  }
  return std::nullopt;
}

bool is_doubtful(std::span<const Evaluation> evaluations, const BlurModel& model, double focus) {
  constexpr double kChance = 6;
  const int side = ring_sides(evaluations).smallest;
  const Pictures pictures = thinned(with_rings(evaluations, side), focus);
  if (side == 0 || pictures.size() < kLeastPictures) return false;
  const SpectralLikelihood likelihood(pictures, side, model);
  const Descent descent(likelihood);
  const Candidate told = descent.at(model, focus);
  const SpectralLikelihood::Cost cost = likelihood.at(told.position);
  const double scale = std::max(1.0, cost.chi_squared / likelihood.freedom());
  for (const double factor : {0.5, 2.0}) {
    BlurModel other = model;
    other.px_per_unit *= factor;
    if ((told.cost - descent.at(other, focus).cost) / 2 / scale > kChance) return true;
  }
  return false;
}

bool agree(const BlurModel& a, const BlurModel& b) {
  constexpr double kSame = 1.5, kSigmas = 3;
  const double apart = std::abs(std::log(a.px_per_unit / b.px_per_unit));
  return apart < std::max(std::log(kSame), kSigmas * std::hypot(a.uncertainty, b.uncertainty));
}

}  // namespace fathom
