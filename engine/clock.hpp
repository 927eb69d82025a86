// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace fathom {

/// What durations are measured with. Tests put one of their own in the machine's place.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Seconds since some moment; steady.
  virtual double wall_s() const = 0;
  /// Seconds that the processors have spent on this process.
  virtual double processor_s() const = 0;
  /// Seconds since 1970, by the machine's calendar.
  virtual double calendar_s() const = 0;
};

/// This machine's.
const Clock& machine_clock();

}  // namespace fathom
