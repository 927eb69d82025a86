// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/frame_clock.hpp"

#include <algorithm>

namespace fathom::v4l2 {
namespace {

/// For drivers that do not tell: slower than nearly every camera.
constexpr std::int64_t kUsualInterval_ns = 1'000'000'000 / 15;

/// A gap larger than this is a counter that jumped.
constexpr std::uint32_t kMostLost = 1U << 20;

}  // namespace

FrameClock::FrameClock(std::int64_t interval_ns, double delay_frames, std::int64_t start_ns)
    : interval_ns_(interval_ns > 0 ? interval_ns : kUsualInterval_ns),
      delay_frames_(delay_frames),
      empty_ns_(start_ns) {}

FrameClock::Stamp FrameClock::stamp_of(const Delivery& delivery) const {
  // A stamp of the future is of some other clock.
  if (delivery.kind != StampKind::none && delivery.stamp_ns > 0 &&
      delivery.stamp_ns <= delivery.taken_ns) {
    return {delivery.kind, delivery.stamp_ns};
  }
  return {StampKind::none, std::min(empty_ns_, delivery.taken_ns)};
}

std::int64_t FrameClock::start_of(const Stamp& stamp, std::int64_t open_ns,
                                  std::int64_t interval_ns) const {
  const std::int64_t sent_ns =
      stamp.ns - static_cast<std::int64_t>(delay_frames_ * static_cast<double>(interval_ns));
  if (stamp.kind == StampKind::exposure) return sent_ns;
  if (stamp.kind == StampKind::first_byte) return sent_ns - open_ns;
  return sent_ns - interval_ns - open_ns;
}

/// No camera sends frames faster than it exposes them, and what was measured before a pause is the
/// best that is known after it.
std::int64_t FrameClock::slowest_interval_ns(std::int64_t exposure_ns) const {
  return std::max({interval_ns_, measured_ns_, exposure_ns});
}

/// A driver that had no buffer since the last frame lost what passed then for want of a reader.
void FrameClock::count(const Delivery& delivery, std::int64_t stamp_ns, std::int64_t exposure_ns) {
  if (!last_) return;
  const std::uint32_t step = delivery.sequence - last_->sequence;
  if (step == 0 || step > kMostLost) return;
  const std::int64_t unread_ns =
      std::max<std::int64_t>(delivery.ready_since_ns - last_->stamp_ns, 0);
  if (unread_ns == 0) {
    measured_ns_ = (stamp_ns - last_->stamp_ns) / step;
    lost_ += step - 1;
    return;
  }
  // The frame that is on its way when a buffer comes is lost as well.
  const std::int64_t excused = unread_ns / slowest_interval_ns(exposure_ns) + 2;
  if (step - 1 > excused) lost_ += static_cast<std::uint64_t>(step - 1 - excused);
}

Exposure FrameClock::read(const Delivery& delivery, std::int64_t exposure_ns) {
  const Stamp stamp = stamp_of(delivery);
  count(delivery, stamp.ns, exposure_ns);
  const std::int64_t interval_ns = slowest_interval_ns(exposure_ns);
  const std::int64_t open_ns = exposure_ns > 0 ? exposure_ns : interval_ns;
  Exposure exposure;
  exposure.start_ns = start_of(stamp, open_ns, interval_ns);
  exposure.end_ns = stamp.kind == StampKind::exposure ? exposure.start_ns + open_ns : stamp.ns;
  if (last_) {
    exposure.start_ns = std::max(exposure.start_ns, last_->exposure.start_ns + 1);
    exposure.end_ns = std::max(exposure.end_ns, last_->exposure.end_ns + 1);
  }
  exposure.end_ns = std::max(exposure.end_ns, exposure.start_ns);
  last_ = {delivery.sequence, stamp.ns, exposure};
  return exposure;
}

}  // namespace fathom::v4l2
