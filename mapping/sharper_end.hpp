// SPDX-License-Identifier: Apache-2.0
// Where a focus lies that pictures do not reach.
#pragma once

#include <optional>
#include <vector>

#include "mapping/depth_result.hpp"

namespace fathom::mapping {

enum class TravelEnd { low, high };

/// The end towards which detail grows, over the whole picture, to the last one or so, beyond what
/// noise makes; nothing where it does not. positions: of the frames that the curves are of.
std::optional<TravelEnd> sharper_end(const CurveGrid& curves, const std::vector<double>& positions);

}  // namespace fathom::mapping
