// SPDX-License-Identifier: Apache-2.0
// The contract of a motorised lens.
//
// A lens moves to absolute positions in its own unit. A move returns when the lens has arrived AND
// settled, with the time on the rig's monotonic clock; backlash is the lens's own affair: every
// move ends from the same side (hal/approach.hpp), so that one position is one place, whichever way
// it came.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "../engine/optics.hpp"

namespace fathom {

/// What a lens is, in its own unit.
struct LensInfo {
  std::string description;  ///< One line for logs and records: driver, model.
  std::string unit;         ///< "steps", "frames", "um", "dioptres": the unit of every position.
  double lowest = 0;        ///< First position it can take.
  double highest = 0;       ///< Last position it can take.
  double resolution = 1;    ///< Smallest move that means anything.

  /// Widest spacing at which no focus peak hides between two samples; what a coarse pass uses.
  /// Follows from the optics where they are known, from the recording's own spacing for a replay; 0
  /// where nobody knows: a search then finds it by halving.
  double coarse_spacing = 1;

  /// The only positions that it can take, increasing, where they are not simply every multiple of
  /// the resolution from `lowest` on (a recorded stack with uneven gaps).
  std::vector<double> stops;

  /// Focal length, aperture and circle of confusion, where they are known: what a depth of field
  /// follows from.
  std::optional<Optics> optics = std::nullopt;
};

/// The position that a lens would take when asked for another: the nearest that it has, the lower
/// of two that are equally near. One rule for every lens, so that a record can be replayed without
/// it.
double nearest_position(const LensInfo& info, double position);

/// How a move ended.
struct Arrival {
  double position = 0;          ///< Where the lens stands now.
  std::int64_t settled_ns = 0;  ///< When it came to rest, on the rig's monotonic clock.
  std::string note;  ///< What the user should know ("nearest recorded position"), or empty.
  std::int64_t started_ns = 0;  ///< When the move began, on the same clock,
  std::int64_t stopped_ns =
      0;  ///< and when the motor stopped; settling lies between this and rest.
};

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

  /// Goes to the lowest position against its stop or switch, which makes absolute positions true
  /// again after steps were lost.
  virtual Arrival home() = 0;

  /// Declares where the lens stands, because somebody has looked. Throws Error(unsupported) for a
  /// lens that knows by itself, Error(out_of_bounds) beyond its limits.
  virtual void declare_at(double position);

 protected:
  Lens() = default;
};

/// Throws what move_to promises for a position that is not a number or beyond the limits.
void require_within(const LensInfo& info, double position);

}  // namespace fathom
