// SPDX-License-Identifier: Apache-2.0
// What the camera tells the host of itself: USB Video Class 1.1, one streaming endpoint (bulk).
#pragma once

#include <cstdint>
#include <vector>

#include "bytes.hpp"
#include "pixel_format.hpp"

namespace fathom::usb {

struct FrameSize {
  int width_px, height_px;
};

constexpr int streaming_interface = 1;
constexpr int streaming_endpoint = 1;

/// Intervals between frames, shortest first, in UVC's unit of 100 ns.
std::vector<std::uint32_t> frame_intervals_100ns(double frames_per_s);

/// The most bytes that a frame takes.
std::uint32_t frame_bytes(const PixelFormat& format, FrameSize size);

Bytes camera_configuration(const std::vector<PixelFormat>& formats,
                           const std::vector<FrameSize>& sizes, double frames_per_s);

}  // namespace fathom::usb
