// SPDX-License-Identifier: Apache-2.0
// Which parts of a map are pieces of one surface that lacks texture in between.
#pragma once

#include <vector>

#include "depth/cells.hpp"
#include "depth/maps.hpp"
#include "depth/moments.hpp"

namespace fathom::depth {

/// Of each part the number of the one that it is joined to, itself or a smaller number. Two are
/// joined where they are neighbours across places without texture, and one plane holds both within
/// their sigmas. owner: the part of each cell, below 0 for none; jumps: of jumps_of().
std::vector<int> joined_parts(const Cells& cells, const DepthMaps& maps,
                              const std::vector<int>& owner, const std::vector<char>& jumps,
                              std::vector<Moments> moments);

}  // namespace fathom::depth
