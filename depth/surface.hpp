// SPDX-License-Identifier: Apache-2.0
// What neighbouring windows tell together: a smooth piece of surface through those that agree.
#pragma once

#include <vector>

#include "depth/nodes.hpp"

namespace fathom::depth {

/// A plane piece of surface about one node. Places in steps of the grid of foci.
struct Facet {
  float place = 0;
  float slope_x = 0;  ///< For each pixel to the right, and down.
  float slope_y = 0;
  float sigma = 0;
  float confidence = 0;
  DepthClass kind = DepthClass::no_texture;
};

/// Row by row, of the finest level.
struct Surface {
  Level level;
  std::vector<Facet> facets;

  const Facet& at(int column, int row) const {
    return facets[static_cast<std::size_t>(row) * level.columns + column];
  }
};

/// Lengths along the travel, in steps of the grid of foci.
struct Scales {
  float apart = 0;        ///< Places farther from each other than this are of two surfaces.
  float least_sigma = 0;  ///< What the law itself does not know of a place.
};

/// Nodes to each side that count in a fit: where their weight has fallen to 0.6.
inline constexpr int kFittedNodes = 2;

/// Fits a quadratic surface to the nodes around each node that lie on one with it. A node that few
/// around it agree with is of two depths.
Surface surface_of(const Nodes& nodes, const Scales& scales, int threads);

}  // namespace fathom::depth
