// SPDX-License-Identifier: Apache-2.0
// Colour to grey, exactly.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fathom::pictures {

/// BT.601 luma, rounded to nearest, in integers so that it is the same everywhere.
template <class Sample>
constexpr Sample luma(Sample red, Sample green, Sample blue) {
  const std::uint32_t sum = 299u * red + 587u * green + 114u * blue;
  return static_cast<Sample>((sum + 500u) / 1000u);
}

/// One row of interleaved samples to grey: 1 channel is copied, 3 are weighed.
template <class Sample>
void grey_row(const Sample* samples, std::size_t width_px, int channels, Sample* grey) {
  for (std::size_t x = 0; x < width_px; ++x) {
    const Sample* pixel = samples + x * static_cast<std::size_t>(channels);
    grey[x] = channels == 1 ? pixel[0] : luma(pixel[0], pixel[1], pixel[2]);
  }
}

}  // namespace fathom::pictures
