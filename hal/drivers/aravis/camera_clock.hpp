// SPDX-License-Identifier: Apache-2.0
// What a camera's own clock says, on the clock of this computer; and what its frame numbers tell.
#pragma once

#include <cstdint>
#include <optional>

namespace fathom::aravis {

/// The camera's clock, latched between two looks at this computer's. Times in ns.
struct Latch {
  std::int64_t before_ns = 0;  ///< On this computer's clock: the request had not been sent,
  std::int64_t after_ns = 0;   ///< and its answer had come.
  std::int64_t camera_ns = 0;

  std::int64_t width_ns() const { return after_ns - before_ns; }
};

/// Two quartzes part by what their makers allow, or by what two latches far apart have shown.
/// Of a time of the camera's it tells the earliest that it can have been here.
class CameraClock {
 public:
  /// The narrowest of a few that were taken in a row.
  void add(const Latch& latch);

  bool is_known() const { return last_.has_value(); }
  /// When the last latch was made; 0 before the first.
  std::int64_t latched_ns() const { return last_ ? last_->after_ns : 0; }

  /// Only where it is known.
  std::int64_t earliest_ns(std::int64_t camera_ns) const;

 private:
  std::optional<Latch> first_, last_;
  double slowest_ = 1 - kMostDrift, fastest_ = 1 + kMostDrift;  // ns here in one of the camera's

  static constexpr double kMostDrift = 200e-6;
};

/// How many frames the numbers say are missing between two that came. Numbers of 16 bits go from
/// 65535 to 1, as GigE Vision has it; a camera that begins anew has lost nothing.
std::uint64_t missing_between(std::uint64_t last, std::uint64_t next);

}  // namespace fathom::aravis
