// SPDX-License-Identifier: Apache-2.0
// Which of a camera's pixel formats and sizes is taken.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/drivers/v4l2/device.hpp"
#include "hal/drivers/v4l2/pixels.hpp"

namespace fathom::v4l2 {

/// A format and a size that a driver agrees to.
struct Mode {
  const PixelFormat* format = nullptr;
  Layout layout;
};

/// What is asked of the choice.
struct ModeWish {
  int width_px = 0;
  int height_px = 0;
  std::optional<Depth> depth;           ///< Either where absent.
  const PixelFormat* format = nullptr;  ///< Any where null.
  double fps = 0;                       ///< Any where 0.
};

/// The mode nearest to a wish: of the depth, then of the size, then as fast as asked for, then best
/// for measuring (pixel_formats()). Changes nothing and does not disturb a stream. Throws
/// Error(unsupported), with what there is, for a camera without a format that is read (or without
/// the one that is asked for).
Mode nearest_mode(const Device& device, const ModeWish& wish);

/// The camera's formats that are read, best first.
std::vector<const PixelFormat*> offered_formats(const Device& device);

/// The sizes of a format, as a short text: "1280 x 720, 640 x 480"; empty where the driver does not
/// tell.
std::string sizes_text(const Device& device, const PixelFormat& format);

/// Puts a mode in force. Throws as Device::fail, and Error(unsupported) if the driver makes
/// something else of it.
Mode set_mode(const Device& device, const Mode& mode);

/// Time from one frame to the next, ns, as the driver says; 0 where it does not.
std::int64_t frame_interval_ns(const Device& device);

/// Asks for a frame rate. Throws Error(unsupported), with the nearest, if it cannot be had.
void set_frame_rate(const Device& device, double fps);

}  // namespace fathom::v4l2
