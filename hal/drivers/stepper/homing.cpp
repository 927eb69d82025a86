// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/stepper/homing.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/error.hpp"

namespace fathom::stepper {
namespace {

constexpr int kClearance = 8;       // steps off the switch, before it is approached again
constexpr double kSlowness = 0.25;  // how much slower that is

using Stopped = std::function<bool()>;

void require_going(const Stopped& is_stopped) {
  if (!is_stopped()) return;
  throw Error(ErrorCode::cancelled,
              "stopped on the way home; where the lens stands is not known until it gets there");
}

/// Goes until the switch answers or lets go.
class Seeker {
 public:
  Seeker(Motor& motor, const Homing& homing, const Stopped& is_stopped)
      : motor_(motor), homing_(homing), is_stopped_(is_stopped) {}

  bool is_closed() { return motor_.lines().read_home_switch() == homing_.closed_level; }

  /// Goes `steps` at most until the switch is closed or open as wanted. Returns the steps made.
  int seek(int steps, const Pace& pace, bool wanted) {
    const auto enough = [&] { return is_stopped_() || is_closed() == wanted; };
    const Motor::Run run = motor_.run(steps, pace, enough);
    require_going(is_stopped_);
    if (run.was_ended || is_closed() == wanted) return run.made;
    throw Error(ErrorCode::device_lost,
                wanted
                    ? fmt::format("no home switch after {} steps; look at its wires, at home and "
                                  "home_when, and whether the motor turns",
                                  -run.made)
                    : fmt::format("the home switch stays closed for {} steps upward; look at its "
                                  "wires, at home_when and at out, and whether the motor turns",
                                  run.made));
  }

 private:
  Motor& motor_;
  const Homing& homing_;
  const Stopped& is_stopped_;
};

/// The second approach is slow and needs no ramp, so that the motor stands at once where the switch
/// answers, and from the same side each time.
int go_to_switch(Motor& motor, const Homing& homing, const Stopped& is_stopped) {
  Seeker seeker(motor, homing, is_stopped);
  const int bound = homing.span + homing.margin;
  int made = 0;
  if (!seeker.is_closed()) made += seeker.seek(-bound, homing.pace, true);
  made += seeker.seek(homing.span, homing.pace, false);  // never beyond the highest position
  made += motor.run(kClearance, homing.pace, is_stopped).made;
  require_going(is_stopped);
  const Pace slow(std::min(kSlowness * homing.pace.rate(), homing.pace.rate_from_rest()));
  return made + seeker.seek(-bound, slow, true);
}

/// The whole travel and more, wherever the counter believes that it is: that is what is in doubt.
int go_to_stop(Motor& motor, const Homing& homing, const Stopped& is_stopped) {
  const Motor::Run run = motor.run(-homing.span - homing.margin, homing.pace, is_stopped);
  require_going(is_stopped);
  return run.made;
}

}  // namespace

int go_home(Motor& motor, const Homing& homing, const Stopped& is_stopped) {
  return homing.by == HomeBy::stop ? go_to_stop(motor, homing, is_stopped)
                                   : go_to_switch(motor, homing, is_stopped);
}

}  // namespace fathom::stepper
