// SPDX-License-Identifier: Apache-2.0
#include "focus/curve.hpp"

#include <algorithm>
#include <iterator>

#include "engine/error.hpp"
#include "engine/quantile.hpp"

namespace fathom {
namespace {

constexpr double kNothing = 1e-3;  // of the median
constexpr double kFloorPart = 0.2;

std::vector<Evaluation> live_of(std::span<const Evaluation> evaluations) {
  std::vector<double> positive;
  for (const Evaluation& e : evaluations) {
    if (e.score > 0) positive.push_back(e.score);
  }
  if (positive.empty()) return {};
  const double least = kNothing * quantile(std::move(positive), 0.5);
  std::vector<Evaluation> live;
  std::copy_if(evaluations.begin(), evaluations.end(), std::back_inserter(live),
               [least](const Evaluation& e) { return e.score > least; });
  return live;
}

double floor_of(std::span<const Evaluation> live) {
  std::vector<double> scores;
  for (const Evaluation& e : live) scores.push_back(e.score);
  return scores.empty() ? 0 : quantile(std::move(scores), kFloorPart);
}

std::size_t index_of_best(std::span<const Evaluation> evaluations) {
  const auto best =
      std::max_element(evaluations.begin(), evaluations.end(),
                       [](const Evaluation& a, const Evaluation& b) { return a.score < b.score; });
  return static_cast<std::size_t>(best - evaluations.begin());
}

}  // namespace

FocusCurve::FocusCurve(std::vector<Evaluation> evaluations) : evaluations_(std::move(evaluations)) {
  std::stable_sort(
      evaluations_.begin(), evaluations_.end(),
      [](const Evaluation& a, const Evaluation& b) { return a.position < b.position; });
  live_ = live_of(evaluations_);
  floor_ = floor_of(live_);
  best_ = index_of_best(evaluations_);
}

std::vector<Evaluation> far_from_focus(const FocusCurve& curve) {
  std::vector<Evaluation> low = curve.live();
  std::stable_sort(low.begin(), low.end(),
                   [](const Evaluation& a, const Evaluation& b) { return a.score < b.score; });
  low.resize(std::min(low.size(), std::max<std::size_t>(2, low.size() / 5)));
  return low;
}

const Evaluation& best_of(std::span<const Evaluation> evaluations) {
  if (evaluations.empty()) throw Error(ErrorCode::bad_argument, "no position was evaluated");
  return evaluations[index_of_best(evaluations)];
}

std::pair<std::size_t, std::size_t> reach(std::span<const Evaluation> curve, std::size_t best,
                                          double least) {
  std::size_t first = best, last = best;
  while (first > 0 && curve[first - 1].score > least) --first;
  while (last + 1 < curve.size() && curve[last + 1].score > least) ++last;
  return {first, last};
}

}  // namespace fathom
