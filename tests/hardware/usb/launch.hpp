// SPDX-License-Identifier: Apache-2.0
// Runs a program once the devices are there, and tells it where.
#pragma once

#include <string>
#include <vector>

namespace fathom::usb {

/// Device file of the camera or GPIO chip that is plugged into vhci-hcd; empty where there is none.
std::string video_device();
std::string gpio_chip();

/// Waits until the wanted ones are there. Throws std::runtime_error after `limit_s`.
void wait_for_devices(bool video, bool gpio, double limit_s);

/// Waits until none is there, or `limit_s`: the kernel takes its time to let go of what was
/// unplugged, and whoever comes next must not find that.
void wait_for_no_devices(double limit_s);

/// Starts a program with FATHOM_VIDEO, FATHOM_GPIOCHIP and FATHOM_USB_SOCKET in its environment.
/// Throws std::runtime_error.
int start_program(const std::vector<std::string>& words, const std::string& socket);

/// Its exit status, 128 + signal where it was killed; -1 while it runs.
int exit_status(int process);

}  // namespace fathom::usb
