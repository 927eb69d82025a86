// SPDX-License-Identifier: Apache-2.0
#include "focus/spectral_side.hpp"

#include <algorithm>
#include <cmath>

namespace fathom {

std::vector<Evaluation> near(std::span<const Evaluation> evaluations, double place,
                             double distance) {
  std::vector<Evaluation> chosen;
  for (const Evaluation& e : evaluations) {
    if (std::abs(e.position - place) <= distance) chosen.push_back(e);
  }
  return chosen;
}

bool is_same_place(const SpectralFit& before, const SpectralFit& now, const BlurModel& model) {
  constexpr double kSigmas = 4, kApartPx = 0.5;
  return before.side != 0 &&
         std::abs(before.position - now.position) <
             kSigmas * std::hypot(before.sigma, now.sigma) + model.units(kApartPx);
}

Neighbours around_sharpest(std::span<const Evaluation> evaluations, int side) {
  const Evaluation* best = &evaluations.front();
  for (const Evaluation& e : evaluations) {
    if (coarse_change(*best, e, side).part > 0) best = &e;
  }
  const Evaluation* other = nullptr;
  for (const Evaluation& e : evaluations) {
    if (&e == best) continue;
    if (other == nullptr ||
        std::abs(e.position - best->position) < std::abs(other->position - best->position))
      other = &e;
  }
  if (best->position < other->position) return {best, other};
  return {other, best};
}

namespace {

/// Which is sharper: +1 the second, -1 the first, 0 where noise hides it.
int sharper_of(const Evaluation& first, const Evaluation& second, int side) {
  const CoarseChange change = coarse_change(first, second, side);
  constexpr double kSigmas = 3, kLeast = 0.002;
  if (std::abs(change.part) < std::max(kSigmas * change.sigma, kLeast)) return 0;
  return change.part > 0 ? 1 : -1;
}

}  // namespace

int sharper_side(std::span<const Evaluation> evaluations, int side) {
  const auto [low, high] = around_sharpest(evaluations, side);
  return sharper_of(*low, *high, side);
}

bool changes(std::span<const Evaluation> evaluations, int side) {
  const auto [low, high] = around_sharpest(evaluations, side);
  const Evaluation& best = coarse_change(*low, *high, side).part > 0 ? *high : *low;
  return std::any_of(evaluations.begin(), evaluations.end(), [&](const Evaluation& e) {
    return e.position != best.position && sharper_of(e, best, side) != 0;
  });
}

bool is_possible(std::span<const Evaluation> evaluations, double focus, const BlurModel& model) {
  const auto [low, high] = std::minmax_element(
      evaluations.begin(), evaluations.end(),
      [](const Evaluation& a, const Evaluation& b) { return a.position < b.position; });
  const int side = ring_sides(evaluations).largest;
  const CoarseChange change = coarse_change(*low, *high, side);
  const double most =
      most_coarse_change(low->position - focus, high->position - focus, side, model);
  constexpr double kSigmas = 5, kLeast = 0.03;
  const double doubt = std::max(kSigmas * change.sigma, kLeast);
  return change.part > std::min(0.0, most) - doubt && change.part < std::max(0.0, most) + doubt;
}

bool is_possible_near(std::span<const Evaluation> evaluations, double focus,
                      const BlurModel& model) {
  const double reach = model.units(ring_sides(evaluations).largest / 4.0);
  return is_possible(near(evaluations, focus, reach), focus, model);
}

}  // namespace fathom
