// SPDX-License-Identifier: Apache-2.0
// Buffers of the driver's memory, filled by it and read by us.
#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hal/drivers/v4l2/device.hpp"
#include "hal/drivers/v4l2/frame_clock.hpp"
#include "hal/stop.hpp"

namespace fathom::v4l2 {

/// How a stream is read.
struct StreamOptions {
  int buffers = 4;
  double delay_frames = 0;
  bool is_uvc = false;  ///< Whose stamps are no starts of exposures, whatever it says.
};

/// A stream that runs from construction to destruction.
class Stream {
 public:
  /// Throws as Device::fail.
  Stream(std::shared_ptr<Device> device, const StreamOptions& options);
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream();

  /// A buffer that the driver has filled. Until release() nobody writes to it.
  struct Filled {
    v4l2_buffer buffer{};
    Delivery delivery;
    std::span<const std::uint8_t> bytes;  ///< Empty for a buffer that the driver calls damaged.
  };

  /// The next one; nothing at `deadline_ns`, which may have passed already: then what is there.
  /// Throws Error(device_lost), Error(io) where the stream is broken, Error(cancelled).
  std::optional<Filled> take(std::int64_t deadline_ns, const StopWatch& watch);

  /// Gives a buffer back to the driver.
  void release(Filled& filled);

  FrameClock& clock() { return clock_; }
  const FrameClock& clock() const { return clock_; }

 private:
  struct Mapping {
    void* memory;
    std::size_t length;
    std::int64_t queued_ns;
  };
  void map_buffers(int count);
  void queue(v4l2_buffer& buffer);
  void close() noexcept;
  bool wait(std::int64_t deadline_ns, const StopWatch& watch);
  bool is_ready(std::chrono::milliseconds timeout);
  StampKind kind_of(const v4l2_buffer& buffer) const;
  std::int64_t ready_since_ns() const;

  std::shared_ptr<Device> device_;
  bool is_uvc_;
  std::vector<Mapping> mappings_;
  FrameClock clock_;
};

}  // namespace fathom::v4l2
