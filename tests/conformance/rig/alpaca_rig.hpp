// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hal/rig_driver.hpp"

namespace fathom::test {

/// A camera and a focuser behind an Alpaca server of the test's own; grey tells where the lens stands.
Hardware open_alpaca_rig(const OpenOptions& options);

}  // namespace fathom::test
