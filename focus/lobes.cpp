// SPDX-License-Identifier: Apache-2.0
#include "focus/lobes.hpp"

#include <algorithm>

namespace fathom {
namespace {

/// The hills that remain when every dip of less than `least` is filled: a walk that turns from
/// climbing to falling only after a fall of `least`, and back only after such a rise.
std::vector<Lobe> walk(const FocusCurve& curve, double least) {
  std::vector<Lobe> lobes;
  std::size_t top = 0, dip = 0, start = 0;
  bool climbing = true;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const double score = curve[i].score;
    if (climbing) {
      if (score > curve[top].score) top = i;
      if (curve[top].score - score < least) continue;
      lobes.push_back({.best = top, .first = start, .last = i});
      climbing = false;
      dip = i;
    } else {
      if (score < curve[dip].score) dip = i;
      if (score - curve[dip].score < least) continue;
      lobes.back().last = start = dip;
      climbing = true;
      top = i;
    }
  }
  if (climbing && !curve.empty()) {
    lobes.push_back({.best = top, .first = start, .last = curve.size() - 1});
  }
  if (!lobes.empty()) lobes.back().last = curve.size() - 1;
  return lobes;
}

}  // namespace

FocusCurve smoothed(const FocusCurve& curve, std::size_t width) {
  std::vector<Evaluation> means = curve.evaluations();
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const std::size_t half = std::min({width / 2, i, curve.size() - 1 - i});
    double sum = 0;
    for (std::size_t k = i - half; k <= i + half; ++k) sum += curve[k].score;
    means[i].score = sum / static_cast<double>(2 * half + 1);
  }
  return FocusCurve(std::move(means));
}

std::vector<Lobe> find_lobes(const FocusCurve& curve, double least) {
  std::vector<Lobe> lobes = walk(curve, least);
  for (Lobe& lobe : lobes) {
    const double top = curve[lobe.best].score;
    lobe.height = top - curve.floor();
    double higher_dip = lobe.first > 0 ? curve[lobe.first].score : curve.floor();
    if (lobe.last + 1 < curve.size()) higher_dip = std::max(higher_dip, curve[lobe.last].score);
    lobe.prominence = top - higher_dip;
  }
  std::stable_sort(lobes.begin(), lobes.end(),
                   [](const Lobe& a, const Lobe& b) { return a.height > b.height; });
  return lobes;
}

}  // namespace fathom
