// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hal/rig_driver.hpp"

namespace fathom::test {

/// A GigE Vision camera with a lens of its own, on the loopback; its grey tells where the lens stands.
Hardware open_gige_rig(const OpenOptions& options);

}  // namespace fathom::test
