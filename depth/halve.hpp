// SPDX-License-Identifier: Apache-2.0
// A picture of half the width and height.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/frame.hpp"

namespace fathom::depth {

/// Grey levels of a halved picture for each one of an 8-bit picture: averages have fractions.
inline constexpr int kFineness = 64;

/// Weights 1 3 3 1 along both axes; a last odd row or column is dropped. The picture of an 8-bit
/// frame has kFineness levels for each grey level, that of a 16-bit frame one. `pixels` is
/// overwritten and held by the frame that is returned. Both sides must be 2 px at least.
Frame halve(const Frame& frame, std::vector<std::uint16_t>& pixels, int threads);

}  // namespace fathom::depth
