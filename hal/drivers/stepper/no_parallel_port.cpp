// SPDX-License-Identifier: Apache-2.0
// In place of parallel_port.cpp where the system has no ppdev.
#include "engine/error.hpp"
#include "hal/drivers/stepper/lines.hpp"

namespace fathom::stepper {

std::unique_ptr<Lines> open_parallel_port(const ParallelPins&, StepRest) {
  throw Error(ErrorCode::unavailable,
              "this build has no parallel ports: they need Linux; use port = \"gpio\"");
}

std::vector<FoundHardware> find_parallel_ports() { return {}; }

}  // namespace fathom::stepper
