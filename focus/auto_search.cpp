// SPDX-License-Identifier: Apache-2.0
#include "focus/auto_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "focus/lobes.hpp"

namespace fathom {
namespace {

/// Evaluations above a score that hang together with the best one, itself included.
int points_above(const FocusCurve& curve, std::size_t best, double least) {
  const auto [first, last] = reach(curve.evaluations(), best, least);
  return static_cast<int>(last - first) + 1;
}

bool sees_the_peak(const SearchTrace& trace, const CoarsePass& pass, const Scatter& scatter) {
  const FocusCurve curve = trace.curve();
  if (!rise_of(curve, scatter).stands_out()) return false;
  if (!pass.is_guess) return true;
  constexpr int kEnough = 3;
  return points_above(curve, curve.best(), curve.floor() + curve.height() / 2) >= kEnough;
}

/// What is known of one lobe while it is refined.
struct View {
  FocusCurve curve;
  std::size_t best = 0;  ///< Of the lobe.
  Peak peak;
};

/// The curve, and its highest evaluation from low to high.
View look(const SearchTrace& trace, double low, double high, double repeat_scatter) {
  View view{trace.curve(), 0, {}};
  const FocusCurve& curve = view.curve;
  double score = -1;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Evaluation& e = curve[i];
    if (e.position < low || e.position > high || e.score <= score) continue;
    view.best = i;
    score = e.score;
  }
  view.peak = fit_peak(curve.evaluations(), view.best, curve.floor(),
                       noise_of(repeat_scatter, curve.floor()));
  return view;
}

/// How far from the best position towards a neighbour the peak lies, as a part of the way, by how
/// far both stand above the floor: a blurred peak's score falls with the square of the distance.
double part_of_way(double best, double neighbour, double floor, double noise) {
  constexpr double kLeast = 0.15, kMost = 0.5;  // the best is the nearest
  if (!(best > floor)) return kMost;            // all scores alike, as on a card in the dark
  const double ratio = std::sqrt((best - floor) / std::max(neighbour - floor, noise));
  return std::clamp(1 / (1 + ratio), kLeast, kMost);
}

/// Where to look while too few points lie on the peak for a shape: on the side of the higher
/// neighbour; but where one side has been looked at more closely, on the other one as close.
double first_guess(const View& view, double noise) {
  const FocusCurve& curve = view.curve;
  const std::size_t b = view.best;
  const double at = curve[b].position;
  const auto towards = [&](const Evaluation& neighbour) {
    const double part = part_of_way(curve[b].score, neighbour.score, curve.floor(), noise);
    return at + part * (neighbour.position - at);
  };
  if (b == 0) return towards(curve[b + 1]);
  if (b + 1 == curve.size()) return towards(curve[b - 1]);
  const double left = at - curve[b - 1].position, right = curve[b + 1].position - at;
  constexpr double kUneven = 1.5;
  if (left > kUneven * right) return at - std::min(right, left / 2);
  if (right > kUneven * left) return at + std::min(left, right / 2);
  return towards(curve[b - 1].score > curve[b + 1].score ? curve[b - 1] : curve[b + 1]);
}

/// Whether a shape describes the peak well enough to ask it where to look: two points stand out of
/// the noise on its upper two thirds.
bool is_shaped(const View& view, double repeat_scatter) {
  const Peak& peak = view.peak;
  if (peak.shape != PeakShape::gaussian && peak.shape != PeakShape::lorentzian) return false;
  constexpr double kSigmas = 3;
  const double floor = view.curve.floor(), height = view.curve[view.best].score - floor;
  const double least = floor + std::max(height / 3, kSigmas * repeat_scatter * floor);
  return points_above(view.curve, view.best, least) >= 2;
}

bool has_point(const View& view, double from, double to) {
  const auto& all = view.curve.evaluations();
  return std::any_of(all.begin(), all.end(),
                     [&](const Evaluation& e) { return e.position >= from && e.position <= to; });
}

/// Places that a trustworthy peak needs a point at, and has none, the most telling first: both
/// slopes and the top. A slope is steepest, and so tells most, some 0.6 to 0.8 half widths from the
/// top.
std::vector<double> missing_places(const View& view) {
  const double at = view.peak.position, width = view.peak.half_width;
  std::vector<double> places;
  if (!has_point(view, at - 1.2 * width, at - 0.4 * width)) places.push_back(at - 0.7 * width);
  if (!has_point(view, at + 0.4 * width, at + 1.2 * width)) places.push_back(at + 0.7 * width);
  if (!has_point(view, at - 0.4 * width, at + 0.4 * width)) places.push_back(at);
  return places;
}

/// Where to look next; nowhere once the peak is known well enough, or the lens has no more places.
std::optional<double> next_place(const SearchTrace& trace, const View& view, double low,
                                 double high, double repeat_scatter, double wanted_sigma) {
  if (view.curve.size() < 2) return std::nullopt;
  const Peak& peak = view.peak;
  std::vector<double> places;
  if (is_shaped(view, repeat_scatter)) {
    places = missing_places(view);
    if (places.empty() && peak.is_judged() && peak.sigma <= wanted_sigma) return std::nullopt;
    for (const double part : {0.7, -0.7, 0.5, -0.5, 0.9, -0.9, 0.0})
      places.push_back(peak.position + part * peak.half_width);
  } else {
    places.push_back(first_guess(view, repeat_scatter * view.curve.floor()));
  }
  for (const double place : places) {
    const double inside = std::clamp(place, low, high);
    if (!trace.has(inside)) return inside;
  }
  return std::nullopt;
}

}  // namespace

void refine_peak(SearchTrace& trace, double low, double high, double repeat_scatter,
                 double tolerance) {
  const double wanted_sigma = tolerance / 8;
  for (int i = 0; i < kRefinements; ++i) {
    const View view = look(trace, low, high, repeat_scatter);
    const auto place = next_place(trace, view, low, high, repeat_scatter, wanted_sigma);
    if (!place) return;
    trace.score_at(*place);
  }
}

namespace {

/// Refines every lobe that could be the focus.
void refine_peaks(SearchTrace& trace, const Scatter& scatter, double tolerance) {
  // The first lobe is the one with the best score. Another one, sampled beside its top, may seem
  // to be a tenth of what it is.
  constexpr double kWorthALook = 0.1;
  std::vector<double> seen;
  constexpr std::size_t kMostLobes = 3;
  while (seen.size() < kMostLobes) {
    const FocusCurve curve = trace.curve();
    const double least = std::max(kWorthALook * curve.height(), noise_of_lobes(curve, scatter));
    const auto lobes = find_lobes(curve, least);
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
    refine_peak(trace, low, high, scatter.repeat, tolerance);
  }
}

void halve_intervals(SearchTrace& trace) {
  const FocusCurve curve = trace.curve();
  for (std::size_t k = 1; k < curve.size(); ++k)
    trace.score_at((curve[k - 1].position + curve[k].position) / 2);
}

}  // namespace

void run_coarse_pass(SearchTrace& trace, const CoarsePass& pass, const Scatter& scatter) {
  evaluate_all(trace, pass.positions);
  for (int i = 0; i < pass.halvings && !sees_the_peak(trace, pass, scatter); ++i)
    halve_intervals(trace);
}

void auto_search(SearchTrace& trace, const CoarsePass& pass, const Scatter& scatter,
                 double tolerance) {
  // A spacing that the lens vouches for is worth a closer look at its best position before it is
  // halved: a faint peak stands out once its top has been found.
  CoarsePass first = pass;
  if (!pass.is_guess) first.halvings = 0;
  run_coarse_pass(trace, first, scatter);
  refine_peaks(trace, scatter, tolerance);
  if (pass.is_guess) return;
  for (int i = 0; i < pass.halvings; ++i) {
    if (rise_of(trace.curve(), scatter).stands_out()) return;
    halve_intervals(trace);
    refine_peaks(trace, scatter, tolerance);
  }
}

}  // namespace fathom
