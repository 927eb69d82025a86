// SPDX-License-Identifier: Apache-2.0
#include "focus_motor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fathom::usb {

FocusMotor::FocusMotor(const FocusMotorOptions& options)
    : options_(options), moves_{{INT64_MIN / 2, options.start, options.start}} {}

void FocusMotor::command(double target, std::int64_t at_ns) {
  if (target == moves_.back().target) return;
  moves_.push_back({at_ns, position_at(at_ns), target});
  // A frame shows the lens as it was some frames ago, not longer.
  constexpr std::int64_t remembered_ns = 10'000'000'000;
  while (moves_.size() > 1 && moves_[1].begin_ns < at_ns - remembered_ns) moves_.pop_front();
}

double FocusMotor::position_at(std::int64_t time_ns) const {
  const auto after = std::find_if(moves_.rbegin(), moves_.rend(),
                                  [&](const Move& move) { return move.begin_ns <= time_ns; });
  return after == moves_.rend() ? moves_.front().from : along(*after, time_ns);
}

double FocusMotor::along(const Move& move, std::int64_t time_ns) const {
  const double elapsed_ms = static_cast<double>(time_ns - move.begin_ns) * 1e-6 - options_.delay_ms;
  const double distance = move.target - move.from;
  const double needed_ms = std::abs(distance) / options_.speed_per_s * 1e3;
  if (elapsed_ms <= 0) return move.from;
  if (elapsed_ms < needed_ms) return move.from + distance * elapsed_ms / needed_ms;
  if (options_.ringing == 0 || distance == 0) return move.target;
  const double after_ms = elapsed_ms - needed_ms;
  // A short move has no way to gather that much.
  const double amplitude = std::copysign(std::min(options_.ringing, std::abs(distance)), distance);
  return move.target + amplitude * std::exp(-after_ms / options_.ringing_decay_ms) *
                           std::sin(2 * std::numbers::pi * after_ms / options_.ringing_period_ms);
}

}  // namespace fathom::usb
