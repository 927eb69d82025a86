// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "serve/procedures.hpp"

namespace fathom::serve {

/// Takes a sweep, tells of the map as it grows, and writes it below the folder. Throws as
/// Session::visit, DepthMaker and write_map, and Error(bad_argument) for too few positions.
void map_depth(Work& work, Rig& rig, Observer& all, Outcome& outcome);

}  // namespace fathom::serve
