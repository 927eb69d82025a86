// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/motor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "hal/drivers/simulated/thin_lens.hpp"

namespace fathom::simulated {

Motor::Motor(std::uint64_t seed, int start, int play, double rate)
    : random_(seed, Stream::motor),
      counter_(start),
      rotor_(start),
      lens_(start),
      play_(play),
      rate_(rate) {}

std::int64_t Motor::step_ns(int steps) {
  const int direction = steps < 0 ? -1 : 1;
  const int count = std::abs(steps);
  counter_ += steps;
  int skipped = count >= kLongMove ? std::exchange(to_lose_, 0) : 0;
  for (int i = 0; i < count; ++i) {
    // The rotor follows at most kStallRate steps a second; which pulses it misses is chance.
    const bool stalled = rate_ > kStallRate && random_.uniform() > kStallRate / rate_;
    if (skipped > 0) {
      --skipped;
    } else if (!stalled) {
      turn(direction);
    }
  }
  return std::llround(count / rate_ * 1e9);
}

/// One step of the rotor; the gears push the lens at either end of their play, until a stop holds
/// it.
void Motor::turn(int direction) {
  const int rotor = rotor_ + direction;
  const int lens = std::clamp(lens_, rotor, rotor + play_);
  if (lens < 0 || lens > kTravelSteps) return;
  rotor_ = rotor;
  lens_ = lens;
}

}  // namespace fathom::simulated
