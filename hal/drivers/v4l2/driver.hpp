// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hal/drivers/v4l2/system.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::v4l2 {

/// What the driver's open() does, on a system that a test may have made up.
Hardware open(System& system, const RigSettings& settings, const OpenOptions& options);

}  // namespace fathom::v4l2
