// SPDX-License-Identifier: Apache-2.0
// Depth from focus as others do it, written from the literature, to be compared with.
#pragma once

#include <span>
#include <vector>

#include "engine/frame.hpp"

namespace fathom::peers {

/// Sum of the modified Laplacian over a square of this side, a Gaussian through its three highest
/// values, a median over 3 x 3 (Nayar, Nakagawa, Shape from focus, 1994). Depth of each pixel, in frames.
std::vector<float> sum_of_modified_laplacian(std::span<const Frame> frames, int side_px);

/// Ring difference filter: the mean of a pixel's nearest neighbours less that of a ring around it,
/// squared, aggregated by a guided filter (Jeon, Surh, Im, Kweon, Ring difference filter for fast and
/// noise robust depth from focus, 2020; He, Sun, Tang, Guided image filtering, 2013).
std::vector<float> ring_difference_filter(std::span<const Frame> frames);

}  // namespace fathom::peers
