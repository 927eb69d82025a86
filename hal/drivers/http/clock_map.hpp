// SPDX-License-Identifier: Apache-2.0
// What another computer's clock says, on this computer's: within the bounds of round trips.
#pragma once

#include <cstdint>
#include <optional>

namespace fathom::http {

/// A time of the other clock, asked for and answered between two times of this one.
struct RoundTrip {
  std::int64_t asked_ns = 0;
  std::int64_t there_ns = 0;
  std::int64_t answered_ns = 0;
};

class ClockMap {
 public:
  /// Two quartzes part by no more than this.
  static constexpr double kDrift = 200e-6;

  /// Throws Error(device_lost) for one that contradicts those before: the other clock has jumped.
  void add(const RoundTrip& trip);

  /// From now on both of the following use one offset, the earliest of now: what is early by the
  /// same time stays in its order to the nanosecond. For a camera and a lens of one clock.
  void freeze();

  /// When that was here, at the earliest: for what must be early, never late.
  std::int64_t earliest(std::int64_t there_ns) const;
  /// When that was here, at the latest.
  std::int64_t latest(std::int64_t there_ns) const;

 private:
  /// The other clock minus this one: at most, at least, and when that was known.
  struct Bound {
    std::int64_t offset_ns = 0;
    std::int64_t known_ns = 0;
  };
  std::int64_t most(std::int64_t now_ns) const;
  std::int64_t least(std::int64_t now_ns) const;

  Bound most_, least_;
  std::int64_t newest_ns_ = 0;  ///< When the last answer came.
  bool has_any_ = false;
  std::optional<std::int64_t> frozen_ns_;  ///< The one offset.
};

}  // namespace fathom::http
