// SPDX-License-Identifier: Apache-2.0
// Speeds that termios has no name for.
#pragma once

namespace fathom::serial {

/// Sets both directions of an open terminal to any speed, baud, and leaves the rest as it is. False
/// where the system or the port cannot do it.
bool set_line_speed(int terminal, int baud);

}  // namespace fathom::serial
