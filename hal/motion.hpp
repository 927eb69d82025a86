// SPDX-License-Identifier: Apache-2.0
// A lens that is watched while it moves.
//
// Lens::start() sends a lens on its way and comes back at once. The Motion that it gives tells when
// the lens has arrived and, of every exposure on the way, where the lens stood: a whole travel can
// be scored without a halt.
//
// Way. It is that of move_to(): upward without a halt, downward too far by the backlash and up
// again. The same positions are refused, before anything moves. A user's wish to stop
// (hal/stop.hpp) ends the move as stop() does; arrived() and wait() then throw Error(cancelled).
//
// Place. A position means where move_to() comes to rest there, the play of the gears taken up. On
// the way down the glass lags behind the motor by the play. What is told is where the glass stood;
// play that is not known exactly is part of sigma. Steps that a motor loses are not seen.
//
// Clock. Times are on the rig's monotonic clock, as in Arrival: CLOCK_MONOTONIC for everything
// real. So the camera of another driver may watch, but not where one of the two is simulated or
// replayed: such a clock is its own.
//
// Life. The lens belongs to its Motion until that is destroyed: every other call that would move it
// throws Error(unavailable), and so does position() until the lens has arrived. Keep the Motion
// until the last frame of interest has come. The lens must outlive it. Destroying it on the way
// stops the lens and waits until the motor stands; where it stands is known afterwards.
//
// Threads. One thread at a time uses a lens, its Motion, and the camera that the same driver opened
// with it. A driver that needs a thread of its own looks after that itself.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "../engine/frame.hpp"

namespace fathom {

/// How a move ended.
struct Arrival {
  double position = 0;          ///< Where the lens stands now.
  std::int64_t started_ns = 0;  ///< When the move began, on the rig's monotonic clock.
  std::int64_t stopped_ns = 0;  ///< When the motor stopped, on the same clock.
  std::int64_t settled_ns = 0;  ///< When the lens came to rest, on the same clock.
  std::string note = {};  ///< What the user should know ("nearest recorded position"), or empty.
};

/// Where a lens stood during a time, in its unit.
struct Where {
  double position = 0;  ///< The mean over that time; between two stops of the lens as a rule.
  double sigma = 0;  ///< Standard uncertainty of it: the play, and how a motor follows its steps.
  double smear = 0;  ///< How far it travelled within that time: highest minus lowest place.
};

/// A move that goes on while frames are exposed, and where it was at any time.
class Motion {
 public:
  virtual ~Motion() = default;
  Motion(const Motion&) = delete;
  Motion& operator=(const Motion&) = delete;

  /// Has the lens come to rest where it is, down the ramp of its motor if there is one, after at
  /// most one step more. Returns at once; nothing happens where the lens stands already.
  virtual void stop() = 0;

  /// What move_to() would have returned, once the lens has arrived and settled; nothing before.
  /// After stop(): where it came to rest, with a note. Throws, every time, what move_to() would
  /// have thrown.
  virtual std::optional<Arrival> arrived() = 0;

  /// The same, but waits for it.
  virtual Arrival wait() = 0;

  /// Where the lens stood while a frame was exposed. From when it came to rest where this motion
  /// found it, to now. Throws Error(bad_argument) for a time outside of that, for an exposure that
  /// nobody stamped or that ends before it starts; Error(unavailable) for a time after the motor
  /// failed.
  Where during(const Exposure& exposure) const;

  /// The same for one moment.
  Where at(std::int64_t time_ns) const { return do_during({time_ns, time_ns}); }

 protected:
  Motion() = default;

 private:
  /// The exposure ends when it starts or later.
  virtual Where do_during(const Exposure& exposure) const = 0;
};

}  // namespace fathom
