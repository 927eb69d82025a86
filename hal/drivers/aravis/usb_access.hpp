// SPDX-License-Identifier: Apache-2.0
// USB3 Vision cameras that are plugged in, and that this user may not open: Aravis does not see them.
#pragma once

#include <vector>

#include "hal/rig_driver.hpp"

namespace fathom::aravis {

/// As Linux lists them; nothing elsewhere.
std::vector<FoundHardware> unreadable_usb_cameras();

}  // namespace fathom::aravis
