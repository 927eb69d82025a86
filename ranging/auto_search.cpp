// SPDX-License-Identifier: Apache-2.0
#include "ranging/auto_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ranging/lobes.hpp"
#include "ranging/noise.hpp"

namespace fathom {
namespace {

/// Evaluations on the upper half of the peak round `best`.
int points_above_half(const std::vector<Evaluation>& curve, std::size_t best, double floor) {
  const double half = floor + (curve[best].score - floor) / 2;
  std::size_t first = best, last = best;
  while (first > 0 && curve[first - 1].score > half) --first;
  while (last + 1 < curve.size() && curve[last + 1].score > half) ++last;
  return static_cast<int>(last - first) + 1;
}

bool sees_the_peak(const SearchTrace& trace, const CoarsePass& pass, const MetricSpec& spec,
                   double repeat_scatter) {
  if (!rise_of(trace.evaluations(), spec, repeat_scatter).stands_out()) return false;
  if (!pass.is_guess) return true;
  const auto curve = sorted_by_position(trace.evaluations());
  constexpr int kEnough = 3;
  return points_above_half(curve, index_of_best(curve), floor_of(curve)) >= kEnough;
}

/// What is known of one lobe while it is refined.
struct View {
  std::vector<Evaluation> curve;
  std::size_t best = 0;
  double floor = 0;
  Peak peak;
};

/// The curve, and its highest evaluation from low to high.
View look(const SearchTrace& trace, double low, double high, double repeat_scatter) {
  View view{sorted_by_position(trace.evaluations()), 0, 0, {}};
  view.floor = floor_of(view.curve);
  double score = -1;
  for (std::size_t i = 0; i < view.curve.size(); ++i) {
    const Evaluation& e = view.curve[i];
    if (e.position < low || e.position > high || e.score <= score) continue;
    view.best = i;
    score = e.score;
  }
  view.peak = fit_peak(view.curve, view.best, view.floor, noise_of(repeat_scatter, view.floor));
  return view;
}

/// Where to look while too few points lie on the peak for a shape. The peak is less than half of
/// the way to a neighbour off, on the side of the higher one; but where one side has been looked at
/// more closely, on the other one as close.
double quarter_step(const View& view) {
  const auto& curve = view.curve;
  const std::size_t b = view.best;
  const double at = curve[b].position;
  if (b == 0) return at + (curve[b + 1].position - at) / 4;
  if (b + 1 == curve.size()) return at - (at - curve[b - 1].position) / 4;
  const double left = at - curve[b - 1].position, right = curve[b + 1].position - at;
  constexpr double kUneven = 1.5;
  if (left > kUneven * right) return at - std::min(right, left / 2);
  if (right > kUneven * left) return at + std::min(left, right / 2);
  return curve[b - 1].score > curve[b + 1].score ? at - left / 4 : at + right / 4;
}

/// Whether a shape describes the peak well enough to ask it where to look.
bool is_shaped(const View& view) {
  const Peak& peak = view.peak;
  if (peak.shape != PeakShape::gaussian && peak.shape != PeakShape::lorentzian) return false;
  return points_above_half(view.curve, view.best,
                           view.floor - (view.curve[view.best].score - view.floor) / 3) >= 2;
}

bool has_point(const View& view, double from, double to) {
  return std::any_of(view.curve.begin(), view.curve.end(),
                     [&](const Evaluation& e) { return e.position >= from && e.position <= to; });
}

/// Places worth an evaluation, the most telling first. A slope is steepest, and so tells most, some
/// 0.6 to 0.8 half widths from the top.
std::vector<double> wishes(const View& view, double wanted_sigma) {
  const double at = view.peak.position, width = view.peak.half_width;
  std::vector<double> places;
  if (!has_point(view, at - 1.2 * width, at - 0.3 * width)) places.push_back(at - 0.7 * width);
  if (!has_point(view, at + 0.3 * width, at + 1.2 * width)) places.push_back(at + 0.7 * width);
  if (!has_point(view, at - 0.45 * width, at + 0.45 * width)) places.push_back(at);
  if (view.peak.is_judged() && view.peak.sigma <= wanted_sigma) return places;
  for (const double part : {0.7, -0.7, 0.5, -0.5, 0.9, -0.9, 0.0})
    places.push_back(at + part * width);
  return places;
}

std::optional<double> next_place(const SearchTrace& trace, const View& view, double low,
                                 double high, double wanted_sigma) {
  if (view.curve.size() < 2) return std::nullopt;
  const std::vector<double> places =
      is_shaped(view) ? wishes(view, wanted_sigma) : std::vector<double>{quarter_step(view)};
  for (const double place : places) {
    const double inside = std::clamp(place, low, high);
    if (!trace.has(inside)) return inside;
  }
  return std::nullopt;
}

/// low, high: the neighbours of the lobe's top when it was found.
void refine(SearchTrace& trace, double low, double high, double repeat_scatter,
            double wanted_sigma) {
  for (int i = 0; i < kRefinements; ++i) {
    const View view = look(trace, low, high, repeat_scatter);
    const auto place = next_place(trace, view, low, high, wanted_sigma);
    if (!place) return;
    trace.score_at(*place);
  }
}

/// Refines every lobe that could be the focus.
void refine_peaks(SearchTrace& trace, const MetricSpec& spec, double repeat_scatter,
                  double tolerance) {
  // The first lobe is the one with the best score. Another one, sampled beside its top, may seem
  // to be a tenth of what it is.
  constexpr double kWorthALook = 0.1;
  std::vector<double> seen;
  constexpr std::size_t kMostLobes = 3;
  while (seen.size() < kMostLobes) {
    const auto curve = sorted_by_position(trace.evaluations());
    const double floor = floor_of(curve), top = curve[index_of_best(curve)].score;
    const double least =
        std::max(kWorthALook * (top - floor), noise_of_lobes(curve, spec, repeat_scatter));
    const auto lobes = find_lobes(curve, floor, least);
    const auto fresh = std::find_if(lobes.begin(), lobes.end(), [&](const Lobe& lobe) {
      return std::none_of(seen.begin(), seen.end(), [&](double position) {
        return position >= curve[lobe.first].position && position <= curve[lobe.last].position;
      });
    });
    if (fresh == lobes.end() || fresh->prominence < least) return;
    const std::size_t b = fresh->best;
    seen.push_back(curve[b].position);
    const double low = curve[b > 0 ? b - 1 : b].position;
    const double high = curve[b + 1 < curve.size() ? b + 1 : b].position;
    refine(trace, low, high, repeat_scatter, tolerance / 8);
  }
}

void halve_intervals(SearchTrace& trace) {
  const auto curve = sorted_by_position(trace.evaluations());
  for (std::size_t k = 1; k < curve.size(); ++k)
    trace.score_at((curve[k - 1].position + curve[k].position) / 2);
}

}  // namespace

void run_coarse_pass(SearchTrace& trace, const CoarsePass& pass, const MetricSpec& spec,
                     double repeat_scatter) {
  evaluate_all(trace, pass.positions);
  for (int i = 0; i < pass.halvings && !sees_the_peak(trace, pass, spec, repeat_scatter); ++i)
    halve_intervals(trace);
}

void auto_search(SearchTrace& trace, const CoarsePass& pass, const MetricSpec& spec,
                 double repeat_scatter, double tolerance) {
  // A spacing that the lens vouches for is worth a closer look at its best position before it is
  // halved: a faint peak stands out once its top has been found.
  CoarsePass first = pass;
  if (!pass.is_guess) first.halvings = 0;
  run_coarse_pass(trace, first, spec, repeat_scatter);
  refine_peaks(trace, spec, repeat_scatter, tolerance);
  if (pass.is_guess) return;
  for (int i = 0; i < pass.halvings; ++i) {
    if (rise_of(trace.evaluations(), spec, repeat_scatter).stands_out()) return;
    halve_intervals(trace);
    refine_peaks(trace, spec, repeat_scatter, tolerance);
  }
}

}  // namespace fathom
