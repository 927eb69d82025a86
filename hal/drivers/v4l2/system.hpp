// SPDX-License-Identifier: Apache-2.0
// What this driver asks of the operating system, and nothing else: a test puts a camera of its own
// behind it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace fathom::v4l2 {

/// Thin: one call of the system each. What fails answers a negative errno; nothing throws.
class System {
 public:
  System() = default;
  System(const System&) = delete;
  System& operator=(const System&) = delete;
  virtual ~System() = default;

  /// A descriptor that never blocks.
  virtual int open(const std::string& path) = 0;
  virtual void close(int descriptor) = 0;
  /// 0, or a negative errno.
  virtual int ioctl(int descriptor, unsigned long request, void* argument) = 0;
  /// Waits for a filled buffer: the events (POLLIN and others), 0 after the timeout.
  virtual int poll(int descriptor, std::chrono::milliseconds timeout) = 0;
  /// Null where the system refuses.
  virtual void* map(int descriptor, std::size_t length, std::int64_t offset) = 0;
  virtual void unmap(void* memory, std::size_t length) = 0;

  /// CLOCK_MONOTONIC.
  virtual std::int64_t now_ns() = 0;
  virtual void sleep_until_ns(std::int64_t time_ns) = 0;

  /// The paths of what a folder holds, sorted; nothing for a folder that is not there.
  virtual std::vector<std::string> list(const std::string& folder) = 0;
  /// The path without links, or as it is where there is nothing.
  virtual std::string resolve(const std::string& path) = 0;
};

System& real_system();

}  // namespace fathom::v4l2
