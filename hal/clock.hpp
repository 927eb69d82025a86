// SPDX-License-Identifier: Apache-2.0
// The clock of real rigs: CLOCK_MONOTONIC, on which Linux stamps the frames of cameras.
#pragma once

#include <cstdint>

namespace fathom {

/// Now, ns. Never jumps; stands still while the computer sleeps.
std::int64_t monotonic_now_ns();

/// Sleeps until a time on that clock; at once if it has passed. A signal does not end it early.
void sleep_until_ns(std::int64_t time_ns);

}  // namespace fathom
