// SPDX-License-Identifier: Apache-2.0
// A recorded stack that was never a file: pictures in memory, as a rig.
#pragma once

#include <vector>

#include "hal/rig_driver.hpp"

namespace fathom::honesty {

/// pictures: one for each position, of one size; positions: increasing, two at least.
Hardware play(std::vector<Frame> pictures, std::vector<double> positions);

}  // namespace fathom::honesty
