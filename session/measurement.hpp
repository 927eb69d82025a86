// SPDX-License-Identifier: Apache-2.0
// One score at one lens position, and what it cost.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "../engine/frame.hpp"
#include "../focus/sample.hpp"

namespace fathom {

/// One score at one lens position. Times are in the order in which they happen, on the rig's clock
/// unless said otherwise.
struct Measurement {
  double position = 0;  ///< As Lens::nearest() promised it; on the way, where the glass stood.
  std::optional<OnTheWay> on_the_way = {};  ///< Absent for a lens at rest.
  /// Where the lens had come to rest before, if it had been stopped on its way.
  std::optional<double> set_out_from = {};
  double score = 0;
  /// What the window's brightness adds to that, through the metric's taper (picture_facts.hpp). A
  /// search looks at the rest.
  double brightness_share = 0;
  /// When the move began; on the way, when the exposure before this one ended. Such a move lasts
  /// until the exposure begins.
  std::int64_t started_ns = 0;
  std::int64_t stopped_ns = 0;  ///< when the motor stopped,
  std::int64_t settled_ns = 0;  ///< and when the lens came to rest.
  Exposure exposure;            ///< From the first to the last frame averaged.
  std::int64_t compute_ns = 0;  ///< From the frame to the score, on this computer's clock.
  int frames = 1;               ///< How many the picture is the mean of.
  PictureFacts picture;         ///< What else the window showed.
  std::string note;             ///< What the lens said of its move, or empty.

  /// What a search is told of it.
  Sample sample() const { return {std::max(0.0, score - brightness_share), picture, on_the_way}; }
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
