// SPDX-License-Identifier: Apache-2.0
// What is known of a map of depth while its frames are taken.
#pragma once

#include <vector>

#include "mapping/depth_result.hpp"

namespace fathom::mapping {

inline constexpr int kNoFrame = -1;

/// The frame in which each of columns x rows blocks of the picture has been sharpest until now, row
/// by row; kNoFrame where it is not sharper there than it mostly is.
std::vector<int> sharpest_frames(const CurveGrid& curves, int columns, int rows);

}  // namespace fathom::mapping
