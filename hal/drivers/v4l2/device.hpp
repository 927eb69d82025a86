// SPDX-License-Identifier: Apache-2.0
// An open V4L2 node, /dev/video0 or /dev/v4l-subdev0, which camera and lens share.
#pragma once

#include <linux/videodev2.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hal/drivers/v4l2/system.hpp"

namespace fathom::v4l2 {

class ControlGuard;

/// A text of a driver's, which may fill its field to the end.
std::string fixed_text(const unsigned char* text, std::size_t size);

/// Whether a node gives pictures by streaming: a camera has others, for data about them.
bool gives_pictures(const v4l2_capability& capability);

/// Whether it gives pictures, but only in several planes of memory, which is not supported.
bool gives_planes_only(const v4l2_capability& capability);

class Device {
 public:
  /// The node, shared with whoever in this program has it open already. Throws Error(unavailable)
  /// for one that is not there or may not be opened.
  static std::shared_ptr<Device> open(System& system, const std::string& path);

  Device(System& system, const std::string& path, int descriptor)
      : system_(system), path_(path), descriptor_(descriptor) {}
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() { system_.close(descriptor_); }

  const std::string& path() const { return path_; }
  System& system() const { return system_; }
  int descriptor() const { return descriptor_; }

  /// 0, or the errno with which the driver refused.
  template <class Argument>
  int attempt(unsigned long request, Argument& argument) const {
    return control(request, &argument);
  }

  /// The same, but a refusal throws: what() is tried is named in the message, "cannot start".
  template <class Argument>
  void call(unsigned long request, Argument& argument, std::string_view what) const {
    if (const int error = control(request, &argument)) fail(error, what);
  }

  /// The same for VIDIOC_G_CTRL and VIDIOC_S_CTRL, where busy means that the device is not ready (a
  /// lens on its way): it is asked again for about a second, and then Error(unavailable).
  void call_control(unsigned long request, v4l2_control& argument, std::string_view what) const;

  /// Does what puts the device back as it was found, in order: each step answers 0 or an errno.
  /// What is refused is tried again for about a second in all, unless the device is gone, or says
  /// that it never takes that.
  void put_back(std::vector<std::function<int()>> steps) const noexcept;

  /// Throws the Error that an errno of this device means: Error(device_lost) if it was unplugged,
  /// Error(unavailable) if somebody else uses it, Error(timeout), Error(io).
  [[noreturn]] void fail(int error, std::string_view what) const;

  /// Keeps automatic focus off as long as anybody holds what it returns, and puts it back after.
  /// Waits half a second for the lens to rest if it was on.
  std::shared_ptr<ControlGuard> hold_focus(const std::shared_ptr<Device>& self);

 private:
  int control(unsigned long request, void* argument) const;

  System& system_;
  std::string path_;
  int descriptor_;
  mutable std::atomic<bool> is_lost_ = false;
  std::weak_ptr<ControlGuard> focus_;
};

}  // namespace fathom::v4l2
