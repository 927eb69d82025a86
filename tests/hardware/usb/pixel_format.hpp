// SPDX-License-Identifier: Apache-2.0
// The pixel formats that the camera offers, by the codes that V4L2 knows them by.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "bytes.hpp"
#include "scene.hpp"

namespace fathom::usb {

struct PixelFormat {
  const char* name;          ///< As v4l2-ctl and rig files have it.
  std::array<char, 4> guid;  ///< First bytes of UVC's GUID; the rest is the same for all.
  int bits_per_pixel;        ///< 0: compressed.
};

/// GREY, YUYV, NV12, MJPG, Y10, Y12, Y16.
const std::vector<PixelFormat>& pixel_formats();

/// How a picture is exposed.
struct Development {
  double gain = 1;   ///< Grey levels per light; 1 gives 65535 for 65535.
  int offset = 0;    ///< Added, in 16-bit grey levels.
  int blueness = 0;  ///< Wrong white balance: added to U, taken from V.
  double noise = 0;  ///< Standard deviation, in 8-bit grey levels.
  std::uint32_t noise_seed = 0;

  bool operator==(const Development&) const = default;
};

/// The bytes of a frame in this format.
Bytes encode(const PixelFormat& format, const Picture& picture, const Development& development);

}  // namespace fathom::usb
