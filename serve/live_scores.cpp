// SPDX-License-Identifier: Apache-2.0
#include "serve/live_scores.hpp"

#include <fmt/format.h>

#include <complex>
#include <cstddef>
#include <utility>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "engine/spectrum_picture.hpp"
#include "engine/windowed_metric.hpp"
#include "session/one_number.hpp"

namespace fathom::serve {
namespace {

void require_count(std::size_t windows) {
  if (windows >= 1 && windows <= LiveScores::kMost) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("{} windows; there may be 1 to {}", windows, LiveScores::kMost));
}

}  // namespace

LiveScores::LiveScores(const std::string& metric, std::vector<Window> windows, int width_px,
                       int height_px, const std::string& backend, const DeviceOptions& device)
    : windows_(std::move(windows)) {
  require_count(windows_.size());
  for (const Window& window : windows_) {
    const WindowedMetric aim = resolve_window(metric, window, width_px, height_px);
    require_one_number(aim.spec);
    scorers_.push_back(std::make_unique<Scorer>(
        select_device(all_backends(), backend, aim.spec, 1, device), aim.spec, aim.window));
  }
  plan_ = scorers_[0]->selection().device->plan(scorers_[0]->spec(), 1);
}

std::vector<double> LiveScores::of(const Frame& frame) {
  std::vector<double> scores;
  for (const auto& scorer : scorers_) scores.push_back(scorer->score(frame));
  return scores;
}

std::vector<std::uint8_t> LiveScores::spectrum(const Frame& frame) {
  const int n = windows_[0].n;
  std::vector<std::complex<double>> coefficients(static_cast<std::size_t>(n) * n);
  plan_->spectrum(frame, windows_[0], coefficients);
  const Frame picture =
      spectrum_picture(plan_->spec().transform, n, coefficients, MagnitudeScale::decibel);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(coefficients.size());
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) bytes.push_back(static_cast<std::uint8_t>(picture.at(x, y)));
  }
  return bytes;
}

}  // namespace fathom::serve
