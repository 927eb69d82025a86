// SPDX-License-Identifier: Apache-2.0
// How a motor that does not know where it stands finds out.
#pragma once

#include <functional>

#include "hal/drivers/stepper/motor.hpp"
#include "hal/drivers/stepper/pace.hpp"

namespace fathom::stepper {

enum class HomeBy {
  nobody,     ///< Only by somebody who looks: Lens::declare_at().
  stop,       ///< Against the mechanical end, where the motor stalls and takes no harm.
  by_switch,  ///< To a switch near the end.
};

struct Homing {
  HomeBy by = HomeBy::nobody;
  int end = 0;                ///< The position of the mechanical end, or where the switch answers.
  int span = 1200;            ///< From there to the highest position, steps.
  int margin = 60;            ///< How much farther than that it looks for the end.
  bool closed_level = false;  ///< The level of the switch's wire when it answers.
  Pace pace{12.5};            ///< How fast it looks.
};

/// Brings the motor down to `end`. Returns the steps that this took, downward negative; against a
/// stop they say nothing about where it came from. Throws Error(device_lost) if the switch never
/// answers, Error(cancelled) when `is_stopped` says so, the motor at rest.
int go_home(Motor& motor, const Homing& homing, const std::function<bool()>& is_stopped);

}  // namespace fathom::stepper
