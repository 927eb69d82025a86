// SPDX-License-Identifier: Apache-2.0
#include "session/grey_levels.hpp"

#include <algorithm>

namespace fathom {

GreyLevels grey_levels_of(const Frame& frame, std::uint32_t most, std::size_t bins) {
  GreyLevels greys{.histogram = std::vector<std::size_t>(bins),
                   .pixels = static_cast<std::size_t>(frame.width_px()) * frame.height_px()};
  std::uint64_t sum = 0;
  for (int y = 0; y < frame.height_px(); ++y) {
    for (int x = 0; x < frame.width_px(); ++x) {
      const std::uint32_t grey = frame.at(x, y);
      const std::size_t bin = std::size_t{grey} * bins / (std::size_t{most} + 1);
      ++greys.histogram[std::min(bin, bins - 1)];
      sum += grey;
      greys.black += grey == 0 ? 1 : 0;
      greys.white += grey >= most ? 1 : 0;
    }
  }
  greys.mean = static_cast<double>(sum) / static_cast<double>(greys.pixels);
  return greys;
}

}  // namespace fathom
