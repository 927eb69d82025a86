// SPDX-License-Identifier: Apache-2.0
// A map of depth as pictures: colours with a scale, shaded relief, classes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mapping/depth_result.hpp"

namespace fathom::mapping {

using Rgb = std::array<std::uint8_t, 3>;

/// Viridis (van der Walt and Smith 2015), interpolated between nine of its published colours: its
/// lightness rises evenly, so that equal steps of depth look equal, in grey print too. part: 0 to 1.
Rgb viridis(double part);

/// An 8-bit picture of one channel with the colours of its values.
struct PalettePicture {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> values;
  std::vector<Rgb> palette;
};

/// Depths from low to high in viridis, grey where there is none, and to the right of them a scale
/// with numbers and the unit.
PalettePicture coloured(const DepthMaps& maps, double low, double high, const std::string& unit);

/// Each pixel's class: its number is DepthClass's.
PalettePicture classes_of(const DepthMaps& maps);
/// The colour of a class in that picture.
Rgb colour_of(DepthClass value);

/// The map as a surface in light from the upper left, steep enough to see; 128 where there is no
/// depth. rises: whether a larger depth is nearer to the eye.
std::vector<std::uint8_t> shaded(const DepthMaps& maps, bool rises);

}  // namespace fathom::mapping
