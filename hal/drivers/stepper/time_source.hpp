// SPDX-License-Identifier: Apache-2.0
// The clock that paces the pulses; a test puts one in its place that costs no time.
#pragma once

#include <cstdint>

namespace fathom::stepper {

class TimeSource {
 public:
  virtual ~TimeSource() = default;
  virtual std::int64_t now_ns() = 0;
  /// Returns at that time or later, at once if it has passed.
  virtual void sleep_until_ns(std::int64_t time_ns) = 0;
};

/// CLOCK_MONOTONIC.
TimeSource& monotonic_time();

/// Sleeps until a time, but asks now and then whether to go on. Returns whether `enough` said so;
/// it is asked at the end in any case.
template <class Enough>
bool sleep_unless(TimeSource& time, std::int64_t until_ns, const Enough& enough) {
  constexpr std::int64_t kSlice_ns = 50'000'000;  // how late a Ctrl-C may be obeyed
  while (time.now_ns() < until_ns) {
    const std::int64_t slice_ns = time.now_ns() + kSlice_ns;
    time.sleep_until_ns(slice_ns < until_ns ? slice_ns : until_ns);
    if (enough()) return true;
  }
  return enough();
}

}  // namespace fathom::stepper
