// SPDX-License-Identifier: Apache-2.0
// A stepper motor with its driver behind four lines: STEP (steps on its rising edge), DIR (high:
// forward), HOME (a switch, low while pressed) and ENABLE (low: the driver is on, as on most).
// Everything that happens on the lines is written to a file, with times, for tests to judge.
#pragma once

#include <cstdint>
#include <deque>
#include <fstream>
#include <mutex>
#include <string>

namespace fathom::usb {

struct StepperOptions {
  int start_steps = 100;  ///< Where it stands when plugged in.
  int least_steps = -20;  ///< Hard ends: the motor turns no further, steps are lost.
  int most_steps = 100000;
  int home_steps = 0;             ///< The switch is pressed from here on down.
  double most_steps_per_s = 200;  ///< A step sooner than that after the last one is lost.
  double settle_us = 20;          ///< DIR must have been still for so long before STEP rises.
  int backlash_steps = 0;         ///< What the carriage lags behind after a turn.
  std::string log;  ///< Lines "time_ns line value motor_steps carriage_steps"; or none.
};

class Stepper {
 public:
  enum Line { step = 0, direction = 1, home = 2, enable = 3 };

  explicit Stepper(const StepperOptions& options);

  void set(Line line, bool high, std::int64_t time_ns);
  bool get(Line line) const;

  /// Where the carriage was at a time, now or up to some seconds ago.
  double carriage_at(std::int64_t time_ns) const;
  /// The next so many steps are lost, whatever the rate.
  void lose_steps(int count);
  /// The state of the lines is that of a device that was just plugged in; the motor stays.
  void reset_lines();
  std::string status() const;

 private:
  void rising_edge(std::int64_t time_ns);
  void turn(int by, std::int64_t time_ns);
  void write_log(std::int64_t time_ns, Line line, bool high);

  mutable std::mutex mutex_;  ///< The camera looks at it from another thread.
  StepperOptions options_;
  std::ofstream log_;
  bool high_[4] = {false, false, true, false};
  int motor_, carriage_;
  std::int64_t last_step_ns_ = INT64_MIN / 2, last_direction_ns_ = INT64_MIN / 2;
  struct Place {
    std::int64_t since_ns;
    int carriage;
  };
  std::deque<Place> places_;
  int to_lose_ = 0;
  std::uint64_t steps_ = 0, lost_ = 0;
};

}  // namespace fathom::usb
