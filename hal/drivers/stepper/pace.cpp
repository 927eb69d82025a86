// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/stepper/pace.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::stepper {
namespace {

constexpr double kSecond_ns = 1e9;
constexpr double kMostLevels = 1e9;

}  // namespace

Pace::Pace(double rate, double acceleration, double start_rate)
    : rate_(rate), acceleration_(acceleration), start_rate_(std::min(start_rate, rate)) {
  if (acceleration_ <= 0) return;
  const double ramp_steps = (rate_ * rate_ - start_rate_ * start_rate_) / (2 * acceleration_);
  highest_level_ = static_cast<int>(std::min(std::ceil(ramp_steps), kMostLevels));
}

int Pace::next_level(int level, int intervals) const {
  return std::max(0, std::min({level + 1, highest_level_, intervals - 1}));
}

std::int64_t Pace::interval_ns(int level) const {
  // Rounded up: a rate is a limit.
  const double shortest_ns = std::ceil(kSecond_ns / rate_);
  if (acceleration_ <= 0) return static_cast<std::int64_t>(shortest_ns);
  const double start = start_rate_ * start_rate_;
  // t(s + 1) - t(s) without the difference of two near numbers.
  const double interval_s = 2 / (std::sqrt(start + 2 * acceleration_ * (level + 1.0)) +
                                 std::sqrt(start + 2 * acceleration_ * level));
  return static_cast<std::int64_t>(std::max(shortest_ns, std::ceil(kSecond_ns * interval_s)));
}

Pace Pace::limited_to(double rate) const {
  return Pace(std::min(rate, rate_), acceleration_, start_rate_);
}

double Pace::rate_from_rest() const { return kSecond_ns / static_cast<double>(interval_ns(0)); }

}  // namespace fathom::stepper
