// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/focus_methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "engine/scorer.hpp"
#include "focus/light.hpp"
#include "focus/lobes.hpp"
#include "focus/noise.hpp"
#include "tools/fathom/gradient_metrics.hpp"
#include "tools/fathom/spectral_method.hpp"

namespace fathom {
namespace {

FocusCurve curve_of(const WindowStack& stack, const std::vector<double>& scores,
                    double light_exponent) {
  std::vector<Evaluation> evaluations;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    evaluations.push_back({static_cast<int>(i) + 1, stack.positions()[i], scores[i]});
    evaluations.back().picture.light = stack.lights()[i];
  }
  return FocusCurve(in_one_light(std::move(evaluations), {.exponent = light_exponent}));
}

/// How far scores of the least sharp picture scatter under such noise, relative to their mean.
double scatter_of(const StackScores& scores_of, const WindowStack& stack,
                  const std::vector<double>& scores, double noise) {
  constexpr std::size_t kTimes = 12;
  constexpr std::uint64_t kSeed = 7000;
  const auto lowest = std::ranges::min_element(scores) - scores.begin();
  const auto again = stack.repeated(static_cast<std::size_t>(lowest), kTimes);
  return relative_scatter(scores_of(again.with_noise(noise, kSeed)));
}

/// Scatter that was measured, of whatever metric: what would follow from a metric's weights is put
/// aside.
Scatter measured_scatter(double scatter) {
  Scatter measured(MetricSpec::standard(Transform::fft, kSmallestWindow), scatter);
  measured.white = scatter;
  measured.light = {};
  return measured;
}

/// Half of the width at half the height, where no shape gave it: by straight lines between points.
double half_width_of(const FocusCurve& curve) {
  const double half = curve.floor() + curve.height() / 2;
  const auto [first, last] = reach(curve.evaluations(), curve.best(), half);
  const auto crossing = [&](std::size_t inside, std::size_t outside) {
    const Evaluation &in = curve[inside], &out = curve[outside];
    const double part = (in.score - half) / std::max(in.score - out.score, 1e-300);
    return in.position + std::min(part, 1.0) * (out.position - in.position);
  };
  const double low = first > 0 ? crossing(first, first - 1) : curve[first].position;
  const double high = last + 1 < curve.size() ? crossing(last, last + 1) : curve[last].position;
  return (high - low) / 2;
}

StackAnswer answer_of(FocusCurve curve, double relative) {
  const Scatter scatter = measured_scatter(relative);
  // Neither noise nor less than a hundredth of the height is a hill.
  const double dip = std::max(noise_of_lobes(curve, scatter), 0.01 * curve.height());
  const std::vector<Lobe> lobes = find_lobes(curve, dip);
  const Lobe& top = lobes.front();
  const std::span<const Evaluation> all = curve.evaluations();
  StackAnswer answer;
  answer.peak = fit_peak(all.subspan(top.first, top.last - top.first + 1), top.best - top.first,
                         curve.floor(), noise_of(scatter, curve));
  answer.stands_out = rise_of(curve, scatter).stands_out();
  answer.is_at_end = top.best == 0 || top.best + 1 == curve.size();
  answer.maxima = static_cast<int>(lobes.size());
  answer.low = curve[top.first].position;
  answer.high = curve[top.last].position;
  if (lobes.size() > 1 && top.height > 0) answer.second_hill = lobes[1].height / top.height;
  answer.contrast = curve.floor() > 0 ? curve.top().score / curve.floor() : 0;
  if (!(answer.peak.half_width > 0)) answer.peak.half_width = half_width_of(curve);
  answer.curve = std::move(curve);
  return answer;
}

/// Scores by a metric of the engine.
StackScores engine_scores(const MetricSpec& spec, const std::string& backend,
                          const DeviceOptions& options) {
  const auto scorer = std::make_shared<Scorer>(stack_scorer(spec, backend, options));
  return [scorer](const WindowStack& stack) { return numbers_of(*scorer, stack); };
}

/// By a function of one window.
StackScores window_by_window(double (*score)(const Frame&, const Window&)) {
  return [score](const WindowStack& stack) {
    const Frame frame = stack.frame();
    std::vector<double> scores;
    for (const Window& window : stack.windows()) scores.push_back(score(frame, window));
    return scores;
  };
}

/// Both are mean squares.
constexpr double kSquared = 2;

struct GradientMetric {
  const char* name;
  double (*score)(const Frame&, const Window&);
};
constexpr GradientMetric kGradientMetrics[] = {{"laplacian-variance", laplacian_variance},
                                               {"tenengrad", tenengrad}};

}  // namespace

Scorer stack_scorer(const MetricSpec& spec, const std::string& backend,
                    const DeviceOptions& options) {
  const std::size_t batch = full_batch(spec.n);
  return Scorer(select_device(all_backends(), backend, spec, batch, options), spec, batch);
}

std::vector<double> numbers_of(Scorer& scorer, const WindowStack& stack) {
  std::vector<double> numbers(stack.size() * scorer.outputs());
  scorer.aim(stack.windows());
  scorer.score(stack.frame(), numbers);
  return numbers;
}

FocusMethod method_by_scores(std::string name, StackScores scores_of, double light_exponent) {
  const auto find = [=](const WindowStack& stack, double noise) {
    const std::vector<double> scores = scores_of(stack);
    return answer_of(curve_of(stack, scores, light_exponent),
                     scatter_of(scores_of, stack, scores, noise));
  };
  return {std::move(name), find};
}

std::vector<std::string> usual_methods() {
  return {
      "fft",          "fft:power:band=0-0.25",   "walsh-sequency",     "walsh-sequency:band=0-0.25",
      "dct:entropy",  "dct:entropy:band=0-0.25", "laplacian-variance", "tenengrad",
      kSpectralMethod};
}

FocusMethod named_method(const std::string& name, int n, const std::string& backend,
                         const DeviceOptions& options) {
  if (name == kSpectralMethod) return spectral_method(n, backend, options);
  for (const GradientMetric& metric : kGradientMetrics) {
    if (name == metric.name)
      return method_by_scores(name, window_by_window(metric.score), kSquared);
  }
  const MetricSpec spec = MetricSpec::parse(name, n);
  if (spec.n != n) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("metric {} is for {} x {} windows, and these are {} x {}; leave N out",
                            spec.text(), spec.n, spec.n, n, n));
  }
  if (spec.outputs() != 1) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("metric {} gives {} numbers, and a focus curve has one of each picture",
                            spec.text(), spec.outputs()));
  }
  return method_by_scores(spec.text(), engine_scores(spec, backend, options), light_exponent(spec));
}

}  // namespace fathom
