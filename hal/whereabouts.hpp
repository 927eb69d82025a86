// SPDX-License-Identifier: Apache-2.0
// Where the motor stands, known from one run to the next, or known to be unknown.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace fathom {

/// A motor at rest, in its own steps.
struct Standing {
  int position = 0;
  /// Whether it came from below, far enough to take up the play of its gears.
  bool is_approached = false;

  bool operator==(const Standing&) const = default;
};

/// Whose position a file keeps; a file that was written for another motor is not believed.
struct Owner {
  std::string motor;  ///< The wires, the travel and which way is up, in one line.
  int lowest = 0;     ///< The farthest that the motor may turn,
  int highest = 0;    ///< either way.
  int backlash = 0;   ///< Where it has changed, a position is believed but its approach is not.
};

/// An open-loop motor has only its counter. This keeps the counter in a file that never lies:
/// before a move begins the file says so, and only a move that ended well says where. Whatever cuts
/// a move off (an exception, a signal, a power cut) leaves the former on the disk.
///
/// Holds a lock beside the file for as long as it lives: a motor is moved by one program at a time.
class Whereabouts {
 public:
  /// Throws Error(unavailable) where somebody else has the lock, Error(io) where it cannot be had
  /// or the file cannot be read.
  Whereabouts(std::filesystem::path path, Owner owner);
  Whereabouts(const Whereabouts&) = delete;
  Whereabouts& operator=(const Whereabouts&) = delete;
  ~Whereabouts();

  /// Nothing where nobody knows; then reason() says why.
  const std::optional<Standing>& standing() const { return standing_; }
  const std::string& reason() const { return reason_; }

  /// From here on nobody knows, because of `doing` ("moving from 0 to 700"), also after a crash.
  /// Throws Error(io), and then nothing has changed and the motor must not move.
  void leave(const std::string& doing);
  /// The motor stands. Throws Error(io); then this object knows, but the next run will not.
  void arrive(const Standing& standing);

 private:
  void lock();
  void read();

  std::filesystem::path path_;
  Owner owner_;
  int lock_ = -1;
  std::optional<Standing> standing_;
  std::string reason_;
};

/// Where the whereabouts of a motor are kept if nobody says otherwise: under $XDG_STATE_HOME or
/// ~/.local/state. Throws Error(unavailable) where neither is known.
std::filesystem::path default_state_path(const std::string& lines_name);

}  // namespace fathom
