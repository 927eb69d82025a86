// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/motor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace fathom::simulated {

Motor::Motor(std::uint64_t seed, int start, int play, double rate, int travel, double stall_rate)
    : random_(seed, Stream::motor),
      counter_(start),
      rotor_(start),
      lens_(start),
      play_(play),
      rate_(rate),
      travel_(travel),
      stall_rate_(stall_rate) {}

void Motor::begin_move(int steps) {
  losing_ = std::abs(steps) >= kLongMove ? std::exchange(to_lose_, 0) : 0;
}

void Motor::make_step(int direction) {
  counter_ += direction;
  // The rotor follows so many steps a second at most; which pulses it misses is chance.
  const bool stalled = rate_ > stall_rate_ && random_.uniform() > followed();
  if (losing_ > 0) {
    --losing_;
  } else if (!stalled) {
    turn(direction);
  }
}

std::int64_t Motor::step_ns(int steps) {
  const int count = std::abs(steps);
  begin_move(steps);
  for (int i = 0; i < count; ++i) make_step(steps < 0 ? -1 : 1);
  return std::llround(count / rate_ * 1e9);
}

/// One step of the rotor; the gears push the lens at either end of their play, until a stop holds
/// it.
void Motor::turn(int direction) {
  const int rotor = rotor_ + direction;
  const int lens = std::clamp(lens_, rotor, rotor + play_);
  if (lens < 0 || lens > travel_) return;
  rotor_ = rotor;
  lens_ = lens;
}

}  // namespace fathom::simulated
