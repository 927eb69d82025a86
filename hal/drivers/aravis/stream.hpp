// SPDX-License-Identifier: Apache-2.0
// The buffers that a camera fills, from when it starts until it is stopped.
#pragma once

#include <cstdint>
#include <memory>

#include "hal/drivers/aravis/device.hpp"
#include "hal/stop.hpp"

namespace fathom::aravis {

struct StreamOptions {
  int buffers = 8;
  int packet_bytes = 0;  ///< Of GigE; 0: what the way to the camera takes.
};

class Stream {
 public:
  /// Starts the camera. Throws as Device::ask, Error(unavailable).
  Stream(std::shared_ptr<Device> device, const StreamOptions& options);
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream();

  /// The next buffer that was filled, whole or not; null if there is none by the deadline. It must be
  /// given back. Throws Error(device_lost), Error(cancelled).
  ArvBuffer* take(std::int64_t deadline_ns, const StopWatch& watch);
  void give_back(ArvBuffer* buffer);

  /// Frames that came while no buffer was free, because nobody grabbed.
  std::uint64_t unread() const;

 private:
  void start(const StreamOptions& options);

  std::shared_ptr<Device> device_;
  ArvStream* stream_ = nullptr;
};

}  // namespace fathom::aravis
