// SPDX-License-Identifier: Apache-2.0
#include "bench/agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "backends/backends.hpp"
#include "bench/scene.hpp"
#include "engine/selection.hpp"

namespace fathom::bench {

double largest_error(const Scorer& scorer, const MetricSpec& spec, std::size_t window_count) {
  const Frame frame = random_frame();
  const auto windows = scattered_windows(spec.n, window_count);
  std::vector<double> scores(windows.size());
  std::vector<double> expected(windows.size());
  scorer(frame, windows, scores);
  select_device(all_backends(), "reference", spec, 1)
      .device->plan(spec, windows.size())
      ->score(frame, windows, expected);
  double largest = 0;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const double error = std::abs(scores[i] / expected[i] - 1);
    if (!(error <= largest)) largest = error;  // so that NaN is kept
  }
  return largest;
}

double tolerance(const MetricSpec& spec) { return is_walsh(spec.transform) ? 1e-5 : 1e-4; }

void require_agreement(std::string_view name, const Scorer& scorer, const MetricSpec& spec) {
  const double error = largest_error(scorer, spec, 1);
  if (error <= tolerance(spec)) return;
  throw std::runtime_error(
      fmt::format("{} is off by {:.1e} in {}: it does other work than the reference, and its time "
                  "means nothing",
                  name, error, spec.text()));
}

}  // namespace fathom::bench
