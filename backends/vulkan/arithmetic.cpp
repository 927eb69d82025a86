// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/arithmetic.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "backends/vulkan/spirv.hpp"
#include "engine/cache.hpp"
#include "engine/tables.hpp"

namespace fathom::vulkan {
namespace {

constexpr int kSide = 16;
constexpr double kTolerance = 1e-6;  // half of what a score may be off (docs/metrics.md)

/// One grey level in one pixel, on nearly white.
Frame probe() {
  std::vector<std::uint16_t> pixels(kSide * kSide, 65534);
  pixels[5 * kSide + 3] = 65535;
  return Frame(kSide, kSide, std::move(pixels));
}

/// Without a taper |F| is 1/N^2 but at zero frequency, so phi = S/N^5, S = SUM u^2 (eq. 5-1;
/// docs/metrics.md calls it phi_1).
double expected_score() {
  const auto arms = tables::lever_arms(Transform::fft, kSide);
  return std::accumulate(arms.begin(), arms.end(), 0.0) / std::pow(kSide, 5);
}

std::string probe_fault(Plan& plan) {
  const double score = plan.score(probe(), {0, 0, kSide}), expected = expected_score();
  if (std::abs(score - expected) <= kTolerance * expected) return {};  // NaN is a fault
  return fmt::format(
      "its floating point arithmetic is not exact enough: a test window scores {:.9g} "
      "instead of {:.9g}",
      score, expected);
}

}  // namespace

std::string arithmetic_fault(const std::string& identity,
                             const std::function<std::unique_ptr<Plan>(const MetricSpec&)>& plan) {
  const std::string file = "vulkan-" + identity + ".arithmetic";
  if (const auto known = read_cached(file, kernels_key())) return *known;
  // The second has every coefficient but that at zero frequency too, but bands are exact.comp's.
  std::string fault;
  for (const char* const spec : {"fft:16:none", "fft:16:none:band=0-0.71"}) {
    if (fault.empty()) fault = probe_fault(*plan(MetricSpec::parse(spec)));
  }
  write_cached(file, kernels_key(), fault);
  return fault;
}

}  // namespace fathom::vulkan
