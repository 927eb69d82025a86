// SPDX-License-Identifier: Apache-2.0
// What the tests on real V4L2 drivers have in common.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <map>
#include <string>

#include "hal/rig_driver.hpp"

namespace fathom::test {

/// The device file that an environment variable names.
std::string device_file(const char* variable);

/// Opens a V4L2 rig by its keys.
Hardware open_v4l2(std::map<std::string, std::string> keys, const OpenOptions& options = {});

/// The first frame that was exposed after a time; a failure and an empty one if none comes.
Frame frame_after(Camera& camera, std::int64_t settled_ns);

/// Sends a command to the simulated USB devices (usb_devices --help); expects "ok".
void usb(const std::string& command);
/// The value that the simulated camera tells of itself: "focus_auto".
double camera_status(const std::string& name);

/// A control of a device, by the name that its driver gives it; set by another program, as it were.
void set_control(const std::string& path, const std::string& name, int value);
int get_control(const std::string& path, std::uint32_t id);

/// Whether a device file is there, and its device behind it.
bool can_be_opened(const std::string& path);

/// The kernel's folder of the USB device behind a device file. It goes when the kernel is done with
/// an unplugged device, which is later than its files say so.
std::string device_folder(const std::string& path);

/// Waits until something holds; false after ten seconds.
bool eventually(const std::function<bool()>& holds);

/// How long a call takes.
std::chrono::milliseconds time_of(const std::function<void()>& call);

}  // namespace fathom::test
