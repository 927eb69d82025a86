// SPDX-License-Identifier: Apache-2.0
// Focal stacks of known depth: a texture, blurred at each pixel by a disc as wide as that pixel is
// out of focus, with photon and read noise, in 8 bits. No light crosses a cliff.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/frame.hpp"

namespace fathom::scenes {

enum class Texture {
  pink,    ///< As natural scenes: as much power in every octave.
  white,   ///< As much at every frequency.
  sparse,  ///< Specks, one for each 160 pixels.
  faint,   ///< Pink, with a standard deviation of 3 grey levels instead of 32.
};
inline constexpr Texture kTextures[] = {Texture::pink, Texture::white, Texture::sparse,
                                        Texture::faint};
const char* to_string(Texture texture) noexcept;

enum class Shape { slope, cone, waves, step };
inline constexpr Shape kShapes[] = {Shape::slope, Shape::cone, Shape::waves, Shape::step};
const char* to_string(Shape shape) noexcept;

struct Options {
  int width_px = 512;
  int height_px = 384;
  int frames = 25;
  double px_per_frame = 1.6;  ///< Diameter of blur that each frame away from the focus adds.
  double noise = 1;           ///< 1: a standard deviation of 1.7 grey levels at a grey of 110.
  unsigned seed = 1;
};

struct Scene {
  std::vector<Frame> frames;
  std::vector<float> depth;  ///< Row by row, in frames.
};

Scene make(Texture texture, Shape shape, const Options& options);

/// The same of any shape: depth in frames at a place, whose u and v go from 0 to 1 over the picture.
using DepthAt = std::function<float(double u, double v)>;
Scene make(Texture texture, const DepthAt& depth_at, const Options& options);

/// Depth of each pixel, in frames: between 0.12 and 0.88 of the way from the first to the last.
std::vector<float> depth_of(Shape shape, const Options& options);

}  // namespace fathom::scenes
