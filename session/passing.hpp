// SPDX-License-Identifier: Apache-2.0
// Frames of a lens that does not halt for them.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>

#include "shot.hpp"

namespace fathom {

/// Which frames of a travel are worth a score. Lengths in the lens's unit.
struct PassingRules {
  double apart = 0;       ///< A frame nearer than this to the one before is passed over.
  double most_smear = 0;  ///< How far the lens may travel within an exposure,
  double most_sigma = 0;  ///< and how uncertain its place may be.
  /// The last frame is one of the lens at rest; else the travel ends when the lens arrives.
  bool ends_at_rest = true;
  /// Where a frame was taken before the lens set out, if one was.
  std::optional<double> seen_at = {};
  /// So many frames in a row of which nobody knows where the lens stood, and it halts.
  int most_unplaced = std::numeric_limits<int>::max();
};

/// How a travel ended.
struct Passage {
  // Frames that were not worth a score:
  int unplaced = 0;     ///< Nobody knows well enough where the lens stood.
  int smeared = 0;      ///< The lens travelled too far meanwhile.
  Arrival arrival;      ///< Where the lens came to rest,
  bool is_cut = false;  ///< short of where it was sent.
};

/// Told of a frame and of where the lens stood; whether to go on. The arrival's times are those of
/// the way since the frame before. The frame is only lent.
using FramePassed = std::function<bool(const Frame&, const Arrival&, const Where&)>;

/// Sends the lens to `to` without a halt, and tells of each frame on the way. Frames from before
/// since_ns, when the lens stood where it begins, are dropped. The lens stands still whichever way
/// it ends. Throws as Lens::start, Motion::arrived and take_one, and Error(device_lost) as arrive().
Passage take_passing(Camera& camera, Lens& lens, double to, std::int64_t since_ns,
                     const PassingRules& rules, const ShotOptions& options,
                     const FramePassed& passed);

}  // namespace fathom
