// SPDX-License-Identifier: Apache-2.0
// How long a device may take, and what becomes of one that takes longer.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include "engine/backend.hpp"
#include "engine/error.hpp"

namespace fathom::gpu {

/// What a batch may take: 60 s and 1 ms a window on a GPU, 600 s and 2 s a window on what computes
/// in software. FATHOM_GPU_TIMEOUT, in seconds, takes the place of both.
class WaitLimit {
 public:
  /// Throws Error(bad_argument) where the variable is no number above 0.
  explicit WaitLimit(DeviceKind kind);

  double seconds(std::size_t windows) const {
    return call_s_ + window_s_ * static_cast<double>(windows);
  }

 private:
  double call_s_, window_s_;
};

/// Error(timeout): the device is given up, and its plans with it.
Error given_up(std::string_view device, double after_s);

/// Keeps until the process ends what a device that was given up may still use, and what could only
/// be destroyed by waiting for it.
void keep_for_ever(std::shared_ptr<void> object);

}  // namespace fathom::gpu
