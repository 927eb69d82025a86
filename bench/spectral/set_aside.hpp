// SPDX-License-Identifier: Apache-2.0
// A simulated rig whose own computing is set aside: what is left is what a measurement takes.
#pragma once

#include <ctime>
#include <memory>

#include "hal/rig_driver.hpp"

namespace fathom {

/// Processor time of this process, all threads, since some time, ms.
inline double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Processor time that camera and lens took, ms: the pictures of a simulated rig.
using Aside = std::shared_ptr<double>;

/// The same rig, without its stage; what it takes is added to `aside`.
Hardware set_aside(Hardware hardware, Aside aside);

}  // namespace fathom
