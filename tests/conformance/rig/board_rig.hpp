// SPDX-License-Identifier: Apache-2.0
// A rig of two drivers on the computer's own clock, made up: a stepper motor on a fake board, and a
// camera beside it that sees where the lens truly is.
#pragma once

#include "hal/rig_driver.hpp"

namespace fathom::test {

Hardware open_board_rig(const OpenOptions& options);

}  // namespace fathom::test
