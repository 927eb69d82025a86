// SPDX-License-Identifier: Apache-2.0
// Each device lives in a thread of its own: one that computes a picture must not hold up the
// edges of a motor's steps.
#pragma once

#include <atomic>
#include <mutex>
#include <thread>

#include "device.hpp"

namespace fathom::usb {

class DeviceThread {
 public:
  explicit DeviceThread(Device& device);
  ~DeviceThread();

  /// Calls what needs the device while its thread does not use it.
  template <typename Action>
  auto with(const Action& action) {
    const std::lock_guard lock(mutex_);
    return action();
  }

 private:
  void live();

  Device& device_;
  std::mutex mutex_;
  std::atomic<bool> ending_ = false;
  std::thread thread_;
};

}  // namespace fathom::usb
