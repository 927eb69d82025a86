// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hal/drivers/v4l2/system.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::v4l2 {

/// The cameras and lenses that are plugged in; changes nothing.
std::vector<FoundHardware> find_hardware(System& system);

}  // namespace fathom::v4l2
