// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/drivers_process.hpp"

#include "engine/error.hpp"
#include "engine/process.hpp"

namespace fathom::gpu {

void require_process_for_drivers() {
  static const unsigned loaded_in = forks();
  if (forks() != loaded_in) {
    throw Error(ErrorCode::unavailable,
                "this process was forked from one that had loaded its drivers, and drivers do not "
                "come along; fork first, or start a program of its own");
  }
  static const bool can_start = can_start_drivers();
  if (can_start) return;
  throw Error(ErrorCode::unavailable,
              "this process may not start the threads that its drivers need (ulimit -u)");
}

}  // namespace fathom::gpu
