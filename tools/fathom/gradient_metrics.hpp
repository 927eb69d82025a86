// SPDX-License-Identifier: Apache-2.0
// Sharpness by neighbouring pixels, as OpenCV's users compute it: no transform, and no metric of
// the engine. Beyond a window's border are its own pixels, mirrored about the outermost, which is
// OpenCV's default; bench/ proves that OpenCV gives the same.
#pragma once

#include "engine/frame.hpp"
#include "engine/window.hpp"

namespace fathom {

/// Variance of the Laplacian: the four neighbours less four times the pixel (Pech-Pacheco et al.
/// 2000).
double laplacian_variance(const Frame& frame, const Window& window);

/// Tenengrad: the mean of gx^2 + gy^2 of Sobel's 3 x 3 gradients (Tenenbaum 1970; Krotkov 1987).
double tenengrad(const Frame& frame, const Window& window);

}  // namespace fathom
