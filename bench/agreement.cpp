// SPDX-License-Identifier: Apache-2.0
#include "bench/agreement.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "backends/backends.hpp"
#include "bench/scene.hpp"
#include "engine/selection.hpp"

namespace fathom::bench {
namespace {

double largest_relative(std::span<const double> scores, std::span<const double> expected) {
  double largest = 0;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const double error = std::abs(scores[i] / expected[i] - 1);
    if (!(error <= largest)) largest = error;  // so that NaN is kept
  }
  return largest;
}

void require_small(double error, double most, std::string_view name, std::string_view metric) {
  if (error <= most) return;
  throw std::runtime_error(fmt::format(
      "{} is off by {:.1e} in {}: it does other work than what it is compared with, and "
      "its time means nothing",
      name, error, metric));
}

}  // namespace

double largest_error(const Scorer& scorer, const MetricSpec& spec, std::size_t window_count) {
  const Frame frame = random_frame();
  const auto windows = scattered_windows(spec.n, window_count);
  std::vector<double> scores(windows.size() * spec.outputs());
  std::vector<double> expected(scores.size());
  scorer(frame, windows, scores);
  select_device(all_backends(), "reference", spec, 1)
      .device->plan(spec, windows.size())
      ->score(frame, windows, expected);
  return largest_relative(scores, expected);
}

double largest_error(const Scorer& scorer, const OtherMetric& metric, int n,
                     std::size_t window_count) {
  const Frame frame = random_frame();
  const auto windows = scattered_windows(n, window_count);
  std::vector<double> scores(windows.size());
  std::vector<double> expected;
  scorer(frame, windows, scores);
  for (const Window& window : windows) expected.push_back(metric.plain(frame, window));
  return largest_relative(scores, expected);
}

double tolerance(const MetricSpec& spec) {
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      return 1e-4;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return 1e-5;
  }
  return 0;
}

void require_agreement(std::string_view name, const Scorer& scorer, const MetricSpec& spec) {
  require_small(largest_error(scorer, spec, 1), tolerance(spec), name, spec.text());
}

void require_agreement(const Scorer& scorer, const OtherMetric& metric, int n) {
  require_small(largest_error(scorer, metric, n, 1), kOtherTolerance, metric.contestant,
                fmt::format("{}:{}", metric.metric, n));
}

}  // namespace fathom::bench
