// SPDX-License-Identifier: Apache-2.0
// Nodes whose windows see both sides of a cliff: what they tell lies in between, where nothing is.
#pragma once

#include "depth/nodes.hpp"
#include "depth/surface.hpp"

namespace fathom::depth {

/// Marks those of low cliffs as of two depths: they look like steep slopes, and the fit of the surface
/// would follow them. Only among those that the smallest windows told.
void doubt_cliffs(const Scales& scales, Nodes& nodes);

}  // namespace fathom::depth
