// SPDX-License-Identifier: Apache-2.0
// How fast the steps of a move follow each other.
#pragma once

#include <cstdint>

namespace fathom::stepper {

/// A speed, with a ramp up to it and down from it if there is an acceleration.
///
/// On a ramp of constant acceleration a from the speed v0, the place s is reached at the time
/// t(s) = (sqrt(v0^2 + 2 a s) - v0) / a. The interval between the steps s and s + 1 of it is that
/// of level s, and no interval is shorter than that of the full speed. A move climbs one level per
/// step and comes down again at its end, so that it is the same read backwards (a trapezoid, or a
/// triangle where it is short), and a move that must stop early knows at once how: go down from the
/// level that it is on.
class Pace {
 public:
  /// Before the first step.
  static constexpr int kAtRest = -1;

  /// rate, start_rate: steps/s; acceleration: steps/s^2, 0 for none, and then start_rate means
  /// nothing.
  explicit Pace(double rate, double acceleration = 0, double start_rate = 0);

  /// The level after `level`, with so many intervals to come, the next one included.
  int next_level(int level, int intervals) const;
  /// Time from one step to the next.
  std::int64_t interval_ns(int level) const;
  /// The steps that a motor on this level must still make to come to rest on its ramp.
  static int steps_to_rest(int level) { return level > 0 ? level + 1 : 0; }

  double rate() const { return rate_; }
  /// The same ramp up to another speed.
  Pace limited_to(double rate) const;
  /// The speed that needs no ramp.
  double rate_from_rest() const;

 private:
  double rate_;
  double acceleration_;
  double start_rate_;
  int highest_level_ = 0;
};

}  // namespace fathom::stepper
