// SPDX-License-Identifier: Apache-2.0
// What a stack of pictures tells of the depth of every pixel.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace fathom {

/// What is known of a place; if nothing, why.
enum class DepthClass : std::uint8_t {
  known,       ///< Position and sigma are numbers.
  filled,      ///< Closed from its surroundings, not measured.
  no_texture,  ///< Nothing there changes with the lens beyond noise.
  two_depths,  ///< A cliff, or two surfaces that do not agree.
  at_end,      ///< Sharpest at, or beyond, an end of the travel.
  outside,     ///< No frame shows it.
};

/// "known", "filled", "no-texture", "two-depths", "at-end", "outside".
const char* to_string(DepthClass value) noexcept;

/// Row by row, width_px * height_px each; NaN where the class is neither known nor filled.
struct DepthMaps {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> position;  ///< In the lens's unit.
  std::vector<float> sigma;     ///< Standard uncertainty of the position, in the lens's unit.
  std::vector<float>
      confidence;  ///< 0 to 1: how sure it is that this is a focus, and the right one.
  std::vector<DepthClass> classes;

  float shared_sigma = 0;  ///< Part of every sigma that is no noise: what the law of blur does not
                           ///< know. A mean over many pixels keeps it.
  /// The ends of what was swept, in the lens's unit; NaN where nobody says them.
  float lowest = std::numeric_limits<float>::quiet_NaN();
  float highest = std::numeric_limits<float>::quiet_NaN();
  float reach_px = 24;  ///< Positions farther from each other than this have noise of their own,
                        ///< and cliffs are smeared over as much, in the mean.
};

}  // namespace fathom
