// SPDX-License-Identifier: Apache-2.0
// What kernels know of rings: which one a coefficient lies in, and how far float may be trusted.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/metric.hpp"

namespace fathom::gpu {

/// Relative error that rounding may leave in the value of a ring, of the 1e-5 that it may have.
inline constexpr double kRingTolerance = 5e-6;

/// ring_is_doubtful of kernels/fft for one ring, in the kernel's units, where the sum of a ring is
/// taken over half of the plane (docs/metrics.md, "Rings in float"). d is the noise of a
/// coefficient, S the ring's sum, t the brightness that is subtracted last, times `brightness`.
///   magnitudes  error <= d min(lead, d/2 SUM 1/|f| + rest) + t
///   power       error <= d (lead sqrt(S) + d rest) + 2 t (sqrt(S) + t)
struct RingRule {
  double lead, rest;
  double floor;       ///< What quantisation to whole grey levels alone would make of S.
  double brightness;  ///< Rounding of what one grey level adds to the ring's coefficients.
};
std::vector<RingRule> ring_rules(const MetricSpec& spec);

/// The table of kernels/fft: bytes [|u|][|v|], four a word, N/2 + 1 rows of N/2 +
/// FATHOM_RING_MARGIN. A ring's number; K + 2 outside of all, and where there is no coefficient.
std::vector<std::uint32_t> ring_words_by_frequency(const MetricSpec& spec);

/// The table of kernels/walsh and kernels/exact: bytes [row][column] of the coefficients at
/// index_by_position(), K outside of all rings.
std::vector<std::uint32_t> ring_words_by_position(const MetricSpec& spec);

}  // namespace fathom::gpu
