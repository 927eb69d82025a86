// SPDX-License-Identifier: Apache-2.0
// A device that is spoken with in text, in numbers: where it is, whether it moves.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "hal/drivers/serial/dialogue.hpp"
#include "hal/drivers/serial/settings.hpp"

namespace fathom::serial {

/// What a device says of itself, in the lens's unit, and when that was true.
struct Look {
  bool is_moving = false;
  std::optional<double> position;  ///< Absent where it does not tell on its way.
  std::int64_t asked_ns = 0;
  std::int64_t heard_ns = 0;
};

class Device {
 public:
  /// Opens the port and begins. Throws as Port and Dialogue::begin.
  explicit Device(const Settings& settings);

  /// "GRBL 1.1 on /dev/ttyUSB0".
  std::string name() const { return profile_.name + " on " + port_.path(); }

  /// Why it does not know where it is; empty where it does.
  std::string why_unknown();
  /// Where it stands, at rest: asked until two answers agree, for a garbled digit is a number too.
  double position();
  /// What it tells that it can reach, where it tells it.
  double lowest() { return number(dialogue_.ask(*profile_.lowest).text) / profile_.scale; }
  double highest() { return number(dialogue_.ask(*profile_.highest).text) / profile_.scale; }

  /// Sends it on its way.
  void send_to(double position);
  /// Whether it moves, and where it is.
  Look look();
  /// Has it come to rest where it is; look() tells when.
  void halt();
  /// Sends it home; look() tells when it is there.
  void send_home();

  /// From now on it counts so that it is at `position` now.
  void count_from(double position);
  /// Whether it said that it lost its place.
  bool is_lost() const { return !dialogue_.lost().empty(); }
  void found_again() { dialogue_.found_again(); }
  /// When it said anything last.
  std::int64_t heard_ns() const { return dialogue_.heard_ns(); }
  bool can_stop() const { return profile_.stop.has_value(); }

 private:
  Look await(const Command& command);
  void require_good(const Command& command, const Answer& answer) const;
  double number(const std::string& text) const;
  double unit_from(const Answer& answer, const Command& command) const;

  Profile profile_;
  Port port_;
  Dialogue dialogue_;
  double zero_ = 0;                   // what it counts where the lens's position is 0
  const Command* awaited_ = nullptr;  // what was said and is answered once the device stands
};

}  // namespace fathom::serial
