// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/stepper/motor.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "hal/clock.hpp"

namespace fathom::stepper {

TimeSource& monotonic_time() {
  class Monotonic final : public TimeSource {
    std::int64_t now_ns() override { return monotonic_now_ns(); }
    void sleep_until_ns(std::int64_t time_ns) override { fathom::sleep_until_ns(time_ns); }
  };
  static Monotonic time;
  return time;
}

Motor::Motor(std::unique_ptr<Lines> lines, TimeSource& time, const Pulse& pulse)
    : lines_(std::move(lines)), time_(time), pulse_(pulse), step_level_(lines_->step_at_open()) {}

void Motor::turn(bool up) {
  const int direction = up ? 1 : -1;
  if (direction == direction_) return;
  time_.sleep_until_ns(last_step_ns_ + pulse_.hold_ns);
  direction_ = 0;
  lines_->write_direction(up == pulse_.up_level);
  direction_ = direction;
  next_step_ns_ = std::max(next_step_ns_, time_.now_ns() + pulse_.setup_ns);
}

/// Times are taken after each write: what a slow port adds makes pulses longer, never shorter.
std::int64_t Motor::write_edge() {
  const bool pulse_level = pulse_.rest ? !*pulse_.rest : !step_level_;
  step_begun_ns_ = time_.now_ns();
  is_at_rest_ = false;
  lines_->write_step(pulse_level);
  step_level_ = pulse_level;
  last_step_ns_ = time_.now_ns();
  return std::midpoint(step_begun_ns_, last_step_ns_);
}

void Motor::step(int direction, StepLog* log) {
  if (log != nullptr) {
    log->make_step(direction, [this] { return write_edge(); });
  } else {
    write_edge();
  }
  next_step_ns_ = last_step_ns_ + pulse_.width_ns;
  if (!pulse_.rest) return;
  time_.sleep_until_ns(next_step_ns_);
  lines_->write_step(*pulse_.rest);
  step_level_ = *pulse_.rest;
  is_at_rest_ = true;
  next_step_ns_ = time_.now_ns() + pulse_.width_ns;
}

void Motor::end_broken_pulse() {
  if (is_at_rest_ || !pulse_.rest) return;
  lines_->write_step(*pulse_.rest);
  step_level_ = *pulse_.rest;
  is_at_rest_ = true;
  next_step_ns_ = std::max(next_step_ns_, time_.now_ns() + pulse_.width_ns);
}

Motor::Run Motor::run(int steps, const Pace& pace, const std::function<bool()>& enough,
                      StepLog* log) {
  Run run;
  if (steps == 0) return run;
  const int sign = steps > 0 ? 1 : -1;
  end_broken_pulse();
  turn(steps > 0);
  int level = Pace::kAtRest;
  for (int remaining = std::abs(steps); remaining > 0;) {
    if (!run.was_ended && sleep_unless(time_, next_step_ns_, enough)) {
      run.was_ended = true;
      remaining = std::min(remaining, Pace::steps_to_rest(level));
      if (remaining == 0) break;
    }
    time_.sleep_until_ns(next_step_ns_);
    const bool has_stopped =
        level > 0 && time_.now_ns() - step_begun_ns_ > 2 * pace.interval_ns(level);
    if (has_stopped) level = Pace::kAtRest;
    step(sign, log);
    run.made += sign;
    --remaining;
    level = remaining > 0 ? pace.next_level(level, remaining) : 0;
    next_step_ns_ = std::max(next_step_ns_, last_step_ns_ + pace.interval_ns(level));
  }
  return run;
}

}  // namespace fathom::stepper
