// SPDX-License-Identifier: Apache-2.0
// What kernels read besides pixels: engine/tables.hpp in the layouts that their heads describe.
#pragma once

#include <cstdint>
#include <vector>

#include "backends/gpu/shape.hpp"
#include "kernels/args.h"

namespace fathom::gpu {

/// The storage buffer FATHOM_TABLES of a kernel, as 32-bit words.
std::vector<std::uint32_t> table_words(const MetricSpec& spec, Kernel kernel);

/// The index u, i or j (DFT order for fft, the metric's own for Walsh) of the coefficient that a
/// butterfly transform leaves at each position: reversed bits for fft, natural order for Walsh.
std::vector<int> index_by_position(const MetricSpec& spec);

/// FATHOM_TOUCHED: the highest frequency, up to N/2, that a constant under the taper has.
int touched_frequency(const MetricSpec& spec);

/// What is the same for every batch: the band, and when float is in doubt (docs/metrics.md, "When
/// float is not enough").
kernels::ScoreArgs args_for(const MetricSpec& spec);

}  // namespace fathom::gpu
