// SPDX-License-Identifier: Apache-2.0
// Two sharpness measures of a window by OpenCV on the calling thread; tools/fathom has them in plain
// loops. Beyond the window's border are its own pixels, mirrored about the outermost: OpenCV's
// default.
#pragma once

#include "bench/peers/peer.hpp"

namespace fathom::bench {

/// Variance of the Laplacian: the four neighbours less four times the pixel.
std::unique_ptr<PreparedPeer> prepare_opencv_laplacian(int n);

/// Tenengrad: the mean of gx^2 + gy^2, of Sobel's 3 x 3 gradients.
std::unique_ptr<PreparedPeer> prepare_opencv_tenengrad(int n);

}  // namespace fathom::bench
