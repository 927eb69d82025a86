// SPDX-License-Identifier: Apache-2.0
// What the camera looks at, and how it looks out of focus. Only whole numbers for each pixel:
// where these programs run, in an emulated processor, floating point is slow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace fathom::usb {

/// Light per pixel; 65535 is the brightest that the sensor sees at its usual exposure.
struct Picture {
  int width_px = 0, height_px = 0;
  std::vector<std::uint16_t> pixels;  ///< [y][x]
};

/// kind: "texture" (noise on all scales, from the seed), "bars" (vertical, 32 px apart), "star"
/// (36 spokes) or the path of a binary PGM file, repeated to fill the picture. Throws
/// std::runtime_error.
Picture make_scene(const std::string& kind, std::uint32_t seed, int width_px, int height_px);

/// Blurred in both directions by a Gaussian of this standard deviation, made of three boxes each.
Picture blurred(const Picture& picture, double sigma_px);

/// One scene at every blur, each made once.
class BlurredScene {
 public:
  explicit BlurredScene(Picture sharp) : sharp_(std::move(sharp)) {}
  /// Rounded to a sixteenth of a pixel. The reference lasts until the next call.
  const Picture& at(double sigma_px);
  /// Equal for two blurs that give the same picture.
  static int level(double sigma_px);

 private:
  Picture sharp_;
  std::map<int, Picture> made_;
};

}  // namespace fathom::usb
