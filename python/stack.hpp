// SPDX-License-Identifier: Apache-2.0
// A stack in memory as a rig: the lens chooses a picture, the camera gives it.
#pragma once

#include <string>
#include <vector>

#include "hal/rig_driver.hpp"
#include "python/arrays.hpp"

namespace fathom::python {

/// Plays pictures as replay: plays a folder of them. positions: one of each picture, in any order;
/// those of one position are averaged. Throws Error(bad_argument), naming Python's arguments, for
/// another number of positions or one that is not finite.
Hardware stack_hardware(Pictures pictures, std::vector<double> positions, std::string unit);

}  // namespace fathom::python
