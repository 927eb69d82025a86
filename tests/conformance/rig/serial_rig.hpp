// SPDX-License-Identifier: Apache-2.0
// A rig of two drivers on the computer's own clock, made up: a rail that GRBL moves, on a
// pseudo-terminal, and a camera beside it that sees where it truly is.
#pragma once

#include "hal/rig_driver.hpp"

namespace fathom::test {

Hardware open_serial_rig(const OpenOptions& options);

}  // namespace fathom::test
