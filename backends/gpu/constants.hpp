// SPDX-License-Identifier: Apache-2.0
// The constants that a kernel is compiled with.
#pragma once

#include <array>
#include <cstdint>

#include "backends/gpu/shape.hpp"
#include "kernels/args.h"

namespace fathom::gpu {

/// Specialisation constants by id (kernels/args.h).
using Constants = std::array<std::uint32_t, FATHOM_CONSTANTS>;

/// What a kernel leaves behind.
enum class Wanted { score = FATHOM_SCORE, coefficients = FATHOM_COEFFICIENTS };

/// depth: of the pixels; exact takes any.
Constants constants_of(const MetricSpec& spec, const Shape& shape, Depth depth, Wanted wanted);

}  // namespace fathom::gpu
