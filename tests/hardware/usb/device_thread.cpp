// SPDX-License-Identifier: Apache-2.0
#include "device_thread.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>

namespace fathom::usb {

DeviceThread::DeviceThread(Device& device) : device_(device), thread_([this] { live(); }) {}

DeviceThread::~DeviceThread() {
  ending_ = true;
  thread_.join();
}

void DeviceThread::live() {
  constexpr std::int64_t look_again_ns = 20'000'000;  // It may have been plugged in meanwhile.
  while (!ending_) {
    const auto [descriptor, due_ns] = with([&] {
      return std::pair{device_.descriptor(), device_.due_ns()};
    });
    const std::int64_t wait_ns =
        std::clamp<std::int64_t>(due_ns - std::min(due_ns, now_ns()), 0, look_again_ns);
    const timespec wait{0, static_cast<long>(wait_ns)};
    pollfd poll{descriptor, POLLIN, 0};
    const bool readable = ::ppoll(&poll, 1, &wait, nullptr) > 0;
    with([&] {
      // A command may have unplugged it since.
      if (readable && device_.descriptor() == descriptor) device_.serve();
      device_.run();
    });
  }
}

}  // namespace fathom::usb
