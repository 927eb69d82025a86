// SPDX-License-Identifier: Apache-2.0
// A page to look at a depth map with: one file that needs nothing beside it.
#pragma once

#include <string>

#include "mapping/depth_result.hpp"

namespace fathom::mapping {

/// The page's HTML: the sharp picture as a JPEG of at most some 1600 px, depth and sigma at up to
/// 300 000 places, focus curves of a coarse grid, and the surface in WebGL.
std::string view_page(const DepthResult& result, const DepthSummary& summary);

}  // namespace fathom::mapping
