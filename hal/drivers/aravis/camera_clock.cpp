// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/aravis/camera_clock.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::aravis {
namespace {

/// Latches nearer to each other tell less of the drift than what quartzes are allowed.
constexpr std::int64_t kFarApart_ns = 1'000'000'000;
/// A quartz that gets warmer differs from what it was on average.
constexpr double kWander = 5e-6;
constexpr std::uint64_t kLastOf16Bits = 65535;
/// More than that is no loss but a camera that was reset.
constexpr std::uint64_t kMostMissing = 10'000;

}  // namespace

void CameraClock::add(const Latch& latch) {
  const bool goes_on = last_ && latch.camera_ns > last_->camera_ns;
  if (!goes_on) *this = CameraClock();  // the camera's clock was set anew
  if (!first_) first_ = latch;
  last_ = latch;
  const std::int64_t passed_ns = latch.camera_ns - first_->camera_ns;
  if (passed_ns < kFarApart_ns) return;
  const auto passed = static_cast<double>(passed_ns);
  const double slowest = static_cast<double>(latch.before_ns - first_->after_ns) / passed;
  const double fastest = static_cast<double>(latch.after_ns - first_->before_ns) / passed;
  const bool is_quartz = slowest < 1 + kMostDrift && fastest > 1 - kMostDrift;
  if (!is_quartz) {  // not ticks of what we took them for, or a jump: from here on anew
    *this = CameraClock();
    first_ = last_ = latch;
    return;
  }
  slowest_ = std::max(1 - kMostDrift, slowest - kWander);
  fastest_ = std::min(1 + kMostDrift, fastest + kWander);
}

std::int64_t CameraClock::earliest_ns(std::int64_t camera_ns) const {
  const auto since = static_cast<double>(camera_ns - last_->camera_ns);
  const double rate = since >= 0 ? slowest_ : fastest_;
  return last_->before_ns + static_cast<std::int64_t>(std::floor(since * rate));
}

std::uint64_t missing_between(std::uint64_t last, std::uint64_t next) {
  const std::uint64_t step = next > last             ? next - last
                             : last <= kLastOf16Bits ? next + kLastOf16Bits - last
                                                     : 0;
  return step > 1 && step <= kMostMissing ? step - 1 : 0;
}

}  // namespace fathom::aravis
