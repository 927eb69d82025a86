// SPDX-License-Identifier: Apache-2.0
// Questions and answers over a line that may drop, repeat and garble what is said.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/drivers/serial/port.hpp"
#include "hal/drivers/serial/profile.hpp"

namespace fathom::serial {

/// What a device answered, and between which moments it can have been true.
struct Answer {
  std::string line;  ///< The whole line.
  std::string text;  ///< What the command's pattern found in it.
  std::int64_t asked_ns = 0;
  std::int64_t heard_ns = 0;
};

/// Speaks with one device, one thing at a time. Every call throws Error(device_lost) where the port
/// has gone or the device says that it lost its place (then lost() tells more), Error(unsupported)
/// where it refuses.
class Dialogue {
 public:
  /// Both must outlive this.
  Dialogue(Port& port, const Profile& profile) : port_(port), profile_(profile) {}

  /// Waits for the greeting and says what is said first. Throws also Error(timeout).
  void begin();

  /// A question, asked again up to twice where no answer comes: answers get lost, and asking changes
  /// nothing. Throws also Error(timeout).
  Answer ask(const Command& question);

  /// An order, which is never repeated. Returns whether its answer came; one without an answer has
  /// it at once.
  bool order(const Command& command, const Place& place = {});

  /// Sends it, and does not wait.
  void say(const Command& command);
  /// Its answer, if it is there by then.
  std::optional<Answer> hear(const Command& command, std::int64_t until_ns);

  /// A stop, which comes in whatever is going on: what it says of that is dropped.
  void interrupt(const Command& command);

  /// Why the device does not know where it is; empty while it does.
  const std::string& lost() const { return lost_; }
  /// Somebody has told it, or it has found out.
  void found_again() { lost_.clear(); }

  /// When anything was heard last.
  std::int64_t heard_ns() const { return heard_ns_; }

 private:
  std::optional<std::string> next_line(std::int64_t until_ns);
  void send(const std::string& text);
  void heed_troubles(const std::string& line);
  std::int64_t timeout_ns() const;
  [[noreturn]] void fail_silent(const Command& question) const;

  Port& port_;
  const Profile& profile_;
  std::vector<std::string> sent_;  // lines that a device which echoes sends back
  std::string lost_;
  std::int64_t asked_ns_ = 0, heard_ns_ = 0;
  bool is_interrupting_ = false;
};

}  // namespace fathom::serial
