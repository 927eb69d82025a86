// SPDX-License-Identifier: Apache-2.0
// One score at one lens position, and what it cost.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "../engine/frame.hpp"

namespace fathom {

/// One score at one lens position. Times are in the order in which they happen, on the rig's clock
/// unless said otherwise.
struct Measurement {
  double position = 0;  ///< As Lens::nearest() promised it.
  double score = 0;
  std::int64_t started_ns = 0;  ///< When the move began,
  std::int64_t stopped_ns = 0;  ///< when the motor stopped,
  std::int64_t settled_ns = 0;  ///< and when the lens came to rest.
  Exposure exposure;            ///< From the first to the last frame averaged.
  std::int64_t compute_ns = 0;  ///< From the frame to the score, on this computer's clock.
  double saturated = 0;         ///< Part of the window's pixels at the maximum, 0..1.
  std::string note;             ///< What the lens said of its move, or empty.
};

/// Where the time of measurements went, s: on the rig's clock, but for computing.
struct TimeSpent {
  double moving = 0;
  double settling = 0;
  double exposing = 0;  ///< From the lens at rest to the last frame's end.
  double computing = 0;
};
TimeSpent time_spent(std::span<const Measurement> measurements);

}  // namespace fathom
