// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/http/clock_map.hpp"

#include "engine/error.hpp"

namespace fathom::http {
namespace {

std::int64_t drift_ns(std::int64_t since_ns) {
  return static_cast<std::int64_t>(ClockMap::kDrift * static_cast<double>(since_ns));
}

}  // namespace

// The other clock was read when this one was somewhere between asked_ns and answered_ns. So it is
// ahead by there - asked at most and by there - answered at least. Both bounds widen with time.

std::int64_t ClockMap::most(std::int64_t now_ns) const {
  return most_.offset_ns + drift_ns(now_ns - most_.known_ns);
}

std::int64_t ClockMap::least(std::int64_t now_ns) const {
  return least_.offset_ns - drift_ns(now_ns - least_.known_ns);
}

void ClockMap::add(const RoundTrip& trip) {
  const std::int64_t now_ns = trip.answered_ns;
  const Bound most_now{trip.there_ns - trip.asked_ns, now_ns};
  const Bound least_now{trip.there_ns - trip.answered_ns, now_ns};
  if (has_any_ && (most_now.offset_ns < least(now_ns) || least_now.offset_ns > most(now_ns))) {
    throw Error(ErrorCode::device_lost,
                "the clock of the computer with the rig has jumped: it was started anew, or slept");
  }
  if (!has_any_ || most_now.offset_ns < most(now_ns)) most_ = most_now;
  if (!has_any_ || least_now.offset_ns > least(now_ns)) least_ = least_now;
  newest_ns_ = now_ns;
  has_any_ = true;
}

void ClockMap::freeze() { frozen_ns_ = most(newest_ns_); }

std::int64_t ClockMap::earliest(std::int64_t there_ns) const {
  return there_ns - frozen_ns_.value_or(most(newest_ns_));
}

std::int64_t ClockMap::latest(std::int64_t there_ns) const {
  return there_ns - frozen_ns_.value_or(least(newest_ns_));
}

}  // namespace fathom::http
