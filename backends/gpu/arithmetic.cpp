// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/arithmetic.hpp"

#include <fmt/format.h>

#include <cmath>
#include <random>
#include <vector>

#include "engine/cache.hpp"

namespace fathom {
const Backend& reference_backend();
}

namespace fathom::gpu {
namespace {

constexpr int kSide = 16;
constexpr double kTolerance = 2e-6;  // docs/metrics.md, "How exact the scores are"

/// By the fast kernel, and by the exact one, which has the bands.
constexpr const char* kSpecs[] = {"fft:16:hann", "fft:16:hann:band=0.1-0.71"};

/// Side by side what single precision alone gets wrong by a thousand tolerances, a smooth slope
/// and one grey level of noise on nearly white, and noise of all levels.
Frame probes() {
  std::minstd_rand random(1989);
  std::vector<std::uint16_t> pixels;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) pixels.push_back(static_cast<std::uint16_t>(2000 * (x + y)));
    for (int x = 0; x < kSide; ++x) {
      pixels.push_back(static_cast<std::uint16_t>(65534 + (random() >> 8) % 2));
    }
    for (int x = 0; x < kSide; ++x) {
      pixels.push_back(static_cast<std::uint16_t>(random() >> 8));
    }
  }
  return Frame(3 * kSide, kSide, std::move(pixels));
}

std::string fault_of(Plan& plan, Plan& oracle) {
  const Frame frame = probes();
  const auto windows = window_grid(frame.width_px(), kSide, {0, 0, kSide}, kSide);
  for (const Window& window : windows) {
    const double score = plan.score(frame, window), right = oracle.score(frame, window);
    if (std::abs(score - right) <= kTolerance * right) continue;  // never of NaN
    return fmt::format(
        "its floating point arithmetic is not exact enough: a test window of {} scores {:.9g} "
        "instead of {:.9g}",
        plan.spec().text(), score, right);
  }
  return {};
}

}  // namespace

std::string arithmetic_fault(std::string_view file, std::string_view key,
                             const std::function<std::unique_ptr<Plan>(const MetricSpec&)>& plan) {
  if (const auto known = read_cached(file, key)) return *known;
  const auto oracle = reference_backend().open(0, {});
  std::string fault;
  for (const char* const text : kSpecs) {
    const MetricSpec spec = MetricSpec::parse(text);
    if (fault.empty()) fault = fault_of(*plan(spec), *oracle->plan(spec, 1));
  }
  if (fault.empty()) write_cached(file, key, fault);  // a fault may be mended tomorrow
  return fault;
}

}  // namespace fathom::gpu
