// SPDX-License-Identifier: Apache-2.0
#include "stepper.hpp"

#include <algorithm>
#include <stdexcept>

namespace fathom::usb {

Stepper::Stepper(const StepperOptions& options)
    : options_(options),
      motor_(options.start_steps),
      carriage_(options.start_steps),
      places_{{INT64_MIN / 2, options.start_steps}} {
  if (options_.log.empty()) return;
  log_.open(options_.log);
  if (!log_) throw std::runtime_error("cannot write " + options_.log);
}

void Stepper::set(Line line, bool high, std::int64_t time_ns) {
  const std::lock_guard lock(mutex_);
  if (line == home || high_[line] == high) return;
  high_[line] = high;
  if (line == direction) last_direction_ns_ = time_ns;
  if (line == step && high) rising_edge(time_ns);
  write_log(time_ns, line, high);
}

bool Stepper::get(Line line) const {
  const std::lock_guard lock(mutex_);
  return line == home ? motor_ > options_.home_steps : high_[line];
}

void Stepper::rising_edge(std::int64_t time_ns) {
  ++steps_;
  const double since_s = static_cast<double>(time_ns - last_step_ns_) * 1e-9;
  const bool too_fast = since_s * options_.most_steps_per_s < 1;
  const bool too_soon =
      static_cast<double>(time_ns - last_direction_ns_) * 1e-3 < options_.settle_us;
  const bool off = high_[enable];
  last_step_ns_ = time_ns;
  const int to = motor_ + (high_[direction] ? 1 : -1);
  const bool at_end = to < options_.least_steps || to > options_.most_steps;
  const bool told = to_lose_ > 0;
  if (told) --to_lose_;
  if (too_fast || too_soon || off || at_end || told) {
    ++lost_;
    return;
  }
  turn(to - motor_, time_ns);
}

// The carriage is somewhere within the play: it moves when the motor has taken it up.
void Stepper::turn(int by, std::int64_t time_ns) {
  motor_ += by;
  const int before = carriage_;
  carriage_ = std::clamp(carriage_, motor_, motor_ + options_.backlash_steps);
  if (carriage_ == before) return;
  places_.push_back({time_ns, carriage_});
  constexpr std::int64_t remembered_ns = 10'000'000'000;
  while (places_.size() > 1 && places_[1].since_ns < time_ns - remembered_ns) places_.pop_front();
}

double Stepper::carriage_at(std::int64_t time_ns) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(places_.rbegin(), places_.rend(),
                                  [&](const Place& place) { return place.since_ns <= time_ns; });
  return found == places_.rend() ? places_.front().carriage : found->carriage;
}

void Stepper::lose_steps(int count) {
  const std::lock_guard lock(mutex_);
  to_lose_ = count;
}

void Stepper::reset_lines() {
  const std::lock_guard lock(mutex_);
  high_[step] = high_[direction] = high_[enable] = false;
}

void Stepper::write_log(std::int64_t time_ns, Line line, bool high) {
  if (!log_.is_open()) return;
  static const char* const names[] = {"STEP", "DIR", "HOME", "ENABLE"};
  log_ << time_ns << ' ' << names[line] << ' ' << high << ' ' << motor_ << ' ' << carriage_ << '\n';
  log_.flush();
}

std::string Stepper::status() const {
  const std::lock_guard lock(mutex_);
  return "motor=" + std::to_string(motor_) + " carriage=" + std::to_string(carriage_) +
         " steps=" + std::to_string(steps_) + " lost=" + std::to_string(lost_);
}

}  // namespace fathom::usb
