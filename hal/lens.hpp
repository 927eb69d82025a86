// SPDX-License-Identifier: Apache-2.0
// The contract of a motorised lens.
//
// A lens moves to absolute positions in its own unit. A move returns when the lens has arrived AND
// settled, with the time on the rig's monotonic clock; backlash is the lens's own affair: every
// move ends from the same side (hal/approach.hpp), so that one position is one place, whichever way
// it came.
#pragma once

#include <memory>
#include <string>

#include "../engine/travel.hpp"
#include "motion.hpp"

namespace fathom {

/// What moves the focus, in a unit of its own. Drivers make them (RigDriver::open).
class Lens {
 public:
  virtual ~Lens() = default;
  Lens(const Lens&) = delete;
  Lens& operator=(const Lens&) = delete;

  virtual LensInfo info() const = 0;

  /// Where the lens stands, in its unit. Throws Error(unavailable) where nobody knows (a motor that
  /// was cut off in mid-move), saying what to do: home(), or declare_at().
  virtual double position() const = 0;

  /// The position that a move to `position` would end at: nearest_position(info(), position).
  double nearest(double position) const { return nearest_position(info(), position); }

  /// Moves and settles. Throws Error(out_of_bounds), without moving, for a position beyond the
  /// limits, Error(bad_argument) for one that is not a number, Error(timeout) or Error(device_lost)
  /// if the motor does not arrive, Error(cancelled) if a stop is requested on the way. The motor
  /// stands still whichever way it ends.
  virtual Arrival move_to(double position) = 0;

  /// Sends the lens on its way to `position` and comes back at once; hal/motion.hpp tells the rest.
  /// Throws what move_to() does before it moves, and Error(unsupported), saying why_unwatched(),
  /// for a lens that cannot be watched.
  virtual std::unique_ptr<Motion> start(double position);

  /// Why this lens cannot tell where it is on its way, in one line of its own words ("its driver
  /// says only where it was sent"); empty where start() can do it. Cheap; touches no hardware.
  virtual std::string why_unwatched() const;
  bool can_be_watched() const { return why_unwatched().empty(); }

  /// Goes to the lowest position against its stop or switch, which makes absolute positions true
  /// again after steps were lost.
  virtual Arrival home() = 0;

  /// Declares where the lens stands, because somebody has looked. Throws Error(unsupported) for a
  /// lens that knows by itself, Error(out_of_bounds) beyond its limits.
  virtual void declare_at(double position);

 protected:
  Lens() = default;
};

}  // namespace fathom
