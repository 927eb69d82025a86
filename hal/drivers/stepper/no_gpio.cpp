// SPDX-License-Identifier: Apache-2.0
// In place of gpio.cpp in a build without libgpiod.
#include "engine/error.hpp"
#include "hal/drivers/stepper/lines.hpp"

namespace fathom::stepper {

std::unique_ptr<Lines> open_gpio(const GpioPins&, StepRest) {
  throw Error(ErrorCode::unavailable,
              "this build has no libgpiod, so it has no GPIO; install libgpiod-dev and build anew, "
              "or use a parallel port");
}

std::vector<FoundHardware> find_gpio_chips() { return {}; }

}  // namespace fathom::stepper
