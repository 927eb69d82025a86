// SPDX-License-Identifier: Apache-2.0
// The wires between this computer and a stepper driver board.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/rig_driver.hpp"

namespace fathom::stepper {

/// Two outputs, STEP and DIR, and perhaps an input for a home switch. Levels are those of the wire:
/// what a level means is the motor's affair. The port belongs to one program at a time. Every call
/// throws Error(device_lost) where the port does not obey.
class Lines {
 public:
  virtual ~Lines() = default;  ///< Puts STEP at rest and DIR as it was found.
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  /// Which port and which of its lines, in one line; the same for the same wires.
  virtual std::string name() const = 0;
  /// The level of STEP after opening.
  virtual bool step_at_open() const = 0;
  virtual void write_step(bool high) = 0;
  virtual void write_direction(bool high) = 0;
  virtual bool has_home_switch() const = 0;
  /// The level of the home switch's wire. Only where there is one.
  virtual bool read_home_switch() = 0;

 protected:
  Lines() = default;
};

/// The level of STEP between two pulses; nothing where every change of level is a step, so that
/// only the level that is there already leaves the motor alone.
using StepRest = std::optional<bool>;

/// Lines of a GPIO chip. A line is a number or a name.
struct GpioPins {
  std::string chip = "gpiochip0";  ///< Name, path or label.
  std::string step;
  std::string direction;
  std::string home;              ///< Empty: no switch.
  std::string home_pull = "up";  ///< "up", "down" or "none": the resistor in the chip.
};

/// Pins of a parallel port.
struct ParallelPins {
  std::string path;  ///< "/dev/parport0".
  int step_bit = 0;  ///< Of the data lines D0 to D7, pins 2 to 9 of the DB-25.
  int direction_bit = 1;
  std::string home;  ///< Empty, or a status line: one of kStatusLines.
};

/// The words for status lines: pins 10, 11, 12, 13 and 15.
inline constexpr std::string_view kStatusLines[] = {"ack", "busy", "paper", "select", "error"};

/// Throw Error(unavailable): not there, no permission, in use, or not in this build;
/// Error(bad_argument): no such line.
std::unique_ptr<Lines> open_gpio(const GpioPins& pins, StepRest rest);
std::unique_ptr<Lines> open_parallel_port(const ParallelPins& pins, StepRest rest);

/// What is there that a motor could hang on.
std::vector<FoundHardware> find_gpio_chips();
std::vector<FoundHardware> find_parallel_ports();

}  // namespace fathom::stepper
