// SPDX-License-Identifier: Apache-2.0
// How many pixels of a picture are how bright.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "../engine/frame.hpp"

namespace fathom {

struct GreyLevels {
  std::vector<std::size_t> histogram;  ///< Pixels of each bin, from black to `most`.
  std::size_t pixels = 0;
  std::size_t black = 0, white = 0;  ///< Pixels at 0, and at `most` or above.
  double mean = 0;                   ///< Grey value.

  /// Of all pixels.
  double part(std::size_t some) const {
    return static_cast<double>(some) / static_cast<double>(pixels);
  }
};

/// most: the grey value that counts as white; what lies above it is of the last bin.
GreyLevels grey_levels_of(const Frame& frame, std::uint32_t most, std::size_t bins);

}  // namespace fathom
