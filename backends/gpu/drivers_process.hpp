// SPDX-License-Identifier: Apache-2.0
// Drivers belong to the process that loaded them, and abort where they get no threads.
#pragma once

namespace fathom::gpu {

/// To be called before drivers are asked for anything. Throws Error(unavailable) in a process that
/// was forked after drivers had been loaded, and where they could not start their threads.
void require_process_for_drivers();

}  // namespace fathom::gpu
