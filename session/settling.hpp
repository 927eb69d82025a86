// SPDX-License-Identifier: Apache-2.0
// How long after a move a picture still changes: measured with the camera itself, so that whatever
// lags behind is in it: the lens that rings, the stamps of the camera, frames in a queue.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rig.hpp"

namespace fathom {

/// One frame after a move.
struct AfterMove {
  double since_ms = 0;  ///< From the motor's stop to the beginning of the frame's exposure.
  double score = 0;
};

/// What the frames after a move say.
struct Settling {
  /// Whether the last third of the frames agree with each other: there was time enough.
  bool is_at_rest = false;
  /// Frames exposed so long after the motor's stop, or longer, see the lens at rest; 0 where
  /// already the first one did.
  double settled_ms = 0;
  double interval_ms = 0;  ///< Between frames: how coarsely settled_ms is known.
  double rest = 0;         ///< The score at rest: the mean of the last third.
  double change = 0;       ///< The greatest deviation from that, in parts of it.
  std::vector<AfterMove> frames;
  std::int64_t ended_ns = 0;  ///< When the last of them ended, on the rig's clock.
};

/// A frame sees the lens at rest if its score is within five sigmas of the mean of the last third,
/// sigma by the differences of neighbours, or within this part of that mean.
inline constexpr double kRestTolerance = 0.01;

/// Judges frames in the order of their exposure. Pure.
Settling judge_settling(std::vector<AfterMove> frames);

/// Moves to `from`, waits there for `rest_ms`, moves to `to` and scores every frame that the camera
/// gives until `watch_ms` after the motor's stop, at least kFewestFrames. The score must change
/// with the position at `to`: a slope of the focus curve, not its top. Throws as Rig::measure.
Settling measure_settling(Rig& rig, double from, double to, double rest_ms, double watch_ms);

inline constexpr int kFewestFrames = 18;

}  // namespace fathom
