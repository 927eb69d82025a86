// SPDX-License-Identifier: Apache-2.0
// From pieces of surface to a map of every pixel.
#pragma once

#include "depth/surface.hpp"

namespace fathom::depth {

/// Each pixel is blended of the pieces around it, or of two depths where they do not meet. Positions
/// by the grid.
DepthMaps upsample(const Surface& surface, int width_px, int height_px, const FocusGrid& grid,
                   const Scales& scales, int threads);

}  // namespace fathom::depth
