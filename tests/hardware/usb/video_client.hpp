// SPDX-License-Identifier: Apache-2.0
// The least of V4L2 that it takes to look through the simulated camera, with nothing of Fathom's
// own V4L2 driver: that one is tested with this camera, so this camera is tested without it.
#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fathom::usb {

struct VideoFrame {
  std::vector<std::uint8_t> bytes;
  bool error = false;  ///< The driver says that it is damaged.
  std::uint32_t sequence = 0;
  double time_s = 0;  ///< CLOCK_MONOTONIC.
};

class VideoClient {
 public:
  /// Opens the device and starts streaming. Throws std::system_error.
  VideoClient(const std::string& device, std::uint32_t fourcc, int width_px, int height_px);
  ~VideoClient();
  VideoClient(const VideoClient&) = delete;
  VideoClient& operator=(const VideoClient&) = delete;

  /// The next frame, or nothing within the timeout. Throws std::system_error (unplugged: ENODEV).
  std::optional<VideoFrame> next(int timeout_ms = 2000);
  /// A frame that was begun well after now: the last of some.
  VideoFrame fresh();

  /// Throws std::system_error.
  void set(std::uint32_t control, int value);
  int get(std::uint32_t control);

 private:
  int request(unsigned long code, void* argument, const char* what);

  int file_ = -1;
  std::vector<std::span<std::uint8_t>> buffers_;
};

/// How sharp a grey picture is: the mean square of the difference of neighbours.
double sharpness(std::span<const std::uint8_t> grey, int width_px);
double mean(std::span<const std::uint8_t> grey);

}  // namespace fathom::usb
