// SPDX-License-Identifier: Apache-2.0
// Stacks whose focus lies beyond their frames.
#pragma once

#include <cstddef>
#include <span>

#include "depth/ends.hpp"
#include "depth/nodes.hpp"
#include "depth/scoring.hpp"

namespace fathom::depth {

/// Where the picture as a whole is sharpest at an end of what was swept, a place is believed only if
/// the largest windows around it are sharpest within, and have more detail there than the picture has
/// at the end. Else it is at the end: what seems a focus is light of something beside it, which is
/// far out of focus. frames, positions: of those that were
/// scored.
void doubt_beyond(const Scoring& scoring, std::span<const std::size_t> frames, const Ends& ends,
                  Nodes& nodes);

}  // namespace fathom::depth
