// SPDX-License-Identifier: Apache-2.0
// The keys of a stepper motor in a rig file.
#pragma once

#include <string>

#include "hal/drivers/stepper/homing.hpp"
#include "hal/drivers/stepper/lines.hpp"
#include "hal/drivers/stepper/motor.hpp"
#include "hal/drivers/stepper/pace.hpp"
#include "hal/lens_traits.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::stepper {

struct Settings {
  bool is_gpio = false;  ///< Else a parallel port.
  GpioPins gpio;
  ParallelPins parallel;
  Pulse pulse;
  Pace pace{25};
  int lowest = 0;      ///< First position that may be asked for,
  int highest = 1200;  ///< and the last.
  Homing homing;
  LensTraits traits;
  std::string state;  ///< Where the position is kept; empty: the usual place.

  /// Steps that a downward move goes too far.
  int backlash_steps() const;
  /// What distinguishes this motor's counter from others: see Owner.
  std::string identity(const std::string& lines_name) const;

  /// Throws Error(bad_argument) for what has no meaning, Error(unsupported) for what the motor
  /// cannot keep (a rate above its limit).
  static Settings read(const RigSettings& settings);
};

}  // namespace fathom::stepper
