// SPDX-License-Identifier: Apache-2.0
// Grey pictures of colour mosaics.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "hal/drivers/aravis/pixels.hpp"

namespace fathom::aravis {

/// Luma of every pixel; a colour that it has not is the mean of its neighbours of that colour. Samples
/// row by row; both sides at least 2.
template <class Sample>
std::vector<Sample> interpolated(const std::vector<Sample>& samples, int width_px, int height_px,
                                 Mosaic mosaic);

/// One colour's pixels. size: of the result, half of that of the mosaic; use: not luma.
template <class Sample>
std::vector<Sample> one_colour(const std::vector<Sample>& samples, int width_px,
                               std::pair<int, int> size, Mosaic mosaic, MosaicUse use);

}  // namespace fathom::aravis
