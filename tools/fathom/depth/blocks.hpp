// SPDX-License-Identifier: Apache-2.0
// A depth map in a terminal.
#pragma once

#include <string>
#include <vector>

#include "mapping/depth_result.hpp"

namespace fathom::cli {

/// The map in rows of digits, `columns` wide: 0 where it is at `low`, 9 at `high`, a point where
/// less than half of a block has a depth. A block is twice as high as wide, as letters are.
std::vector<std::string> depth_blocks(const DepthMaps& maps, double low, double high, int columns);

}  // namespace fathom::cli
