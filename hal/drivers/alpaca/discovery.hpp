// SPDX-License-Identifier: Apache-2.0
// Which Alpaca servers answer in the networks of this computer.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/drivers/alpaca/connection.hpp"

namespace fathom::alpaca {

/// Asks by UDP on port 32227, and listens for so long. Empty too where the network cannot be asked.
std::vector<Address> discover(std::int64_t listen_ns);

/// The port that an answer names; 0 for what is no answer.
int port_in(std::string_view answer);

}  // namespace fathom::alpaca
