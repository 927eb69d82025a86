// SPDX-License-Identifier: Apache-2.0
// What the windows tell of the places in their middles.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "depth/levels.hpp"
#include "depth/maps.hpp"
#include "depth/profile.hpp"

namespace fathom::depth {

/// Of one node. Places are counted in steps of the grid of foci.
struct Peak {
  float place = 0;
  float sigma = 0;
  float told = 0;        ///< Chi-squared that it explains.
  float confidence = 0;  ///< Part of the likelihood that belongs to this peak.
  float side_px = 0;     ///< Of the windows that told it, in the mean;
  float dx_px = 0;       ///< where they lie by what they tell, from the node.
  float dy_px = 0;
  DepthClass kind = DepthClass::no_texture;
};

/// The peak of a window's profile, which is chi-squared explained at each focus. Whether its detail
/// bears it out is not looked at.
Peak peak_of(std::span<const float> profile);

/// Row by row, those of the finest level.
struct Nodes {
  Level level;
  std::vector<Peak> peaks;

  const Peak& at(int column, int row) const {
    return peaks[static_cast<std::size_t>(row) * level.columns + column];
  }
};

}  // namespace fathom::depth
