// SPDX-License-Identifier: Apache-2.0
#include "focus/parts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fathom {
namespace {

/// The curve of one part; empty where it is not known.
FocusCurve curve_of_part(std::vector<Evaluation> evaluations, std::size_t part,
                         const Scatter& scatter) {
  for (Evaluation& e : evaluations) {
    e.score = e.picture.parts[part];
    if (!(e.score > 0)) return {};
  }
  return FocusCurve(in_one_light(std::move(evaluations), scatter.light));
}

/// A peak that is more than noise and has a shape.
std::optional<Peak> clear_peak(const FocusCurve& curve, const Scatter& scatter) {
  if (curve.size() < kFewestLive + 2 || !rise_of(curve, scatter).stands_out()) return std::nullopt;
  constexpr double kShaped = 0.8;
  Peak peak = fit_peak(curve.evaluations(), curve.best(), curve.floor(), noise_of(scatter, curve));
  if (!peak.is_judged() || peak.r_squared < kShaped) return std::nullopt;
  // Shapes are likenesses: no part is believed to be elsewhere by less than this of its width.
  constexpr double kUnlike = 0.04;
  peak.sigma = std::hypot(peak.sigma, kUnlike * peak.half_width);
  peak.score -= curve.floor();  // from here on a height
  return peak;
}

/// Without what tells nothing of parts, for they are copied many times.
std::vector<Evaluation> scores_of_parts(std::vector<Evaluation> evaluations) {
  for (Evaluation& e : evaluations) {
    e.picture.rings = {};
    e.picture.cells = {};
  }
  return evaluations;
}

/// The peaks of the parts that take part: one that rises to a tenth of the highest does not change
/// the whole window's.
std::vector<Peak> peaks_of_parts(const std::vector<Evaluation>& evaluations,
                                 const Scatter& scatter) {
  const std::vector<Evaluation> bare = scores_of_parts(evaluations);
  std::vector<Peak> peaks;
  double highest = 0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const auto peak = clear_peak(curve_of_part(bare, part, scatter), scatter);
    if (!peak) continue;
    highest = std::max(highest, peak->score);
    peaks.push_back(*peak);
  }
  constexpr double kTakesPart = 0.1;
  std::erase_if(peaks, [&](const Peak& peak) { return peak.score < kTakesPart * highest; });
  std::sort(peaks.begin(), peaks.end(),
            [](const Peak& a, const Peak& b) { return a.position < b.position; });
  return peaks;
}

/// Standard deviation of the positions, weighted by height, less what their sigmas make of it; 0
/// where that is chance.
double spread_of(std::span<const Peak> peaks) {
  double weights = 0, mean = 0, squares = 0, own = 0, chi_squared = 0, precision = 0, middle = 0;
  for (const Peak& peak : peaks) {
    weights += peak.score;
    mean += peak.score * peak.position;
    precision += 1 / (peak.sigma * peak.sigma);
    middle += peak.position / (peak.sigma * peak.sigma);
  }
  if (peaks.size() < 2) return 0;
  mean /= weights;
  middle /= precision;
  for (const Peak& peak : peaks) {
    squares += peak.score * std::pow(peak.position - mean, 2) / weights;
    own += peak.score * peak.sigma * peak.sigma / weights;
    chi_squared += std::pow((peak.position - middle) / peak.sigma, 2);
  }
  const double free = static_cast<double>(peaks.size()) - 1;
  const bool is_chance = chi_squared < free + 3 * std::sqrt(2 * free);
  return is_chance ? 0 : std::sqrt(std::max(0.0, squares - own));
}

double height_of(std::span<const Peak> peaks) {
  double height = 0;
  for (const Peak& peak : peaks) height += peak.score;
  return height;
}

double middle_of(std::span<const Peak> peaks) {
  double sum = 0;
  for (const Peak& peak : peaks) sum += peak.score * peak.position;
  return sum / height_of(peaks);
}

/// Parts the peaks at the widest gap; they are two heaps where a peak of one has fallen to less than
/// half where the next one's is, and that is no chance.
Depths::Two two_heaps(std::span<const Peak> peaks) {
  std::size_t cut = 0;
  double widest = 0;
  for (std::size_t i = 1; i < peaks.size(); ++i) {
    const double gap = peaks[i].position - peaks[i - 1].position;
    if (gap > widest) widest = gap, cut = i;
  }
  if (cut == 0) return {};
  const Peak &below = peaks[cut - 1], &above = peaks[cut];
  constexpr double kSigmas = 4;
  if (widest < std::max(below.half_width, above.half_width) ||
      widest < kSigmas * std::hypot(below.sigma, above.sigma))
    return {};
  auto first = peaks.first(cut), second = peaks.subspan(cut);
  if (height_of(first) < height_of(second)) std::swap(first, second);
  return {middle_of(first), middle_of(second), height_of(second) / height_of(first)};
}

}  // namespace

Depths depths_of(const std::vector<Evaluation>& evaluations, const Scatter& part_scatter) {
  Depths depths;
  depths.parts = peaks_of_parts(evaluations, part_scatter);
  depths.spread = spread_of(depths.parts);
  depths.two = two_heaps(depths.parts);
  return depths;
}

}  // namespace fathom
