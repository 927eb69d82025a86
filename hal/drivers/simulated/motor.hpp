// SPDX-License-Identifier: Apache-2.0
// The lens's stepper motor: what it is told and what it does.
#pragma once

#include <cstdint>

#include "hal/drivers/simulated/random.hpp"
#include "hal/drivers/simulated/thin_lens.hpp"

namespace fathom::simulated {

/// Above this rate the motor stalls and loses steps (thesis T10).
inline constexpr double kStallRate = 40;

/// A motor that counts the steps it is told, turns through those it makes, and drags the lens along
/// through gears with play. Going upward the lens stands where the motor stands; going downward it
/// lags behind by the play. The lens stops at both ends of its travel, and then the motor stands
/// still too.
class Motor {
 public:
  /// start: where lens, motor and counter stand; play: of the gears; all in steps. rate: steps/s;
  /// travel: how far the lens goes; stall_rate: above it steps are lost.
  Motor(std::uint64_t seed, int start, int play, double rate, int travel = kTravelSteps,
        double stall_rate = kStallRate);

  /// Makes steps, upward if positive; returns how long it took.
  std::int64_t step_ns(int steps);

  // The same one by one: the move is announced, and then each of its steps made.
  void begin_move(int steps);
  void make_step(int direction);

  /// Makes the next move of at least kLongMove steps silently lose this many.
  static constexpr int kLongMove = 50;
  void lose_in_next_long_move(int steps) { to_lose_ = steps; }

  /// Where the counter of steps believes it is.
  int counter() const { return counter_; }
  /// Declares where the lens is.
  void set_counter(int position) { counter_ = position; }
  /// Where the lens truly is.
  int lens() const { return lens_; }
  double rate() const { return rate_; }
  int travel() const { return travel_; }
  /// How many of its steps it makes.
  double followed() const { return rate_ > stall_rate_ ? stall_rate_ / rate_ : 1; }

 private:
  void turn(int direction);

  Random random_;
  int counter_;
  int rotor_;
  int lens_;
  int play_;
  int to_lose_ = 0;
  int losing_ = 0;  // of the steps of this move
  double rate_;
  int travel_;
  double stall_rate_;
};

}  // namespace fathom::simulated
