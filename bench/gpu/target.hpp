// SPDX-License-Identifier: Apache-2.0
// A device that is timed: what only its own backend can do with it, past the public interface.
#pragma once

#include <memory>
#include <string>

#include "bench/gpu/work.hpp"
#include "engine/backend.hpp"

namespace fathom::bench {

class Target {
 public:
  virtual ~Target() = default;
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  virtual const DeviceInfo& info() const = 0;
  virtual std::uint64_t buffer_bytes() const = 0;
  /// Then nothing works any more.
  virtual bool is_lost() const = 0;

  virtual std::unique_ptr<Plan> plan(const MetricSpec& spec, std::size_t capacity) = 0;

  /// Two frames that are on the device before the clock starts, scored again and again; scores come
  /// to the host's memory as the kernel gives them.
  virtual std::unique_ptr<Work> resident(const Pixels& pixels, const Cell& cell) = 0;

  /// The way of a fresh frame to the device, with the host's copy into memory that the device can
  /// read (or without it: what the link alone gives), and nothing computed. Null where there is no
  /// such way, because device and host share their memory.
  virtual std::unique_ptr<Work> upload(const Pixels& pixels, const Cell& cell,
                                       bool copies_on_host) = 0;

 protected:
  Target() = default;
};

/// A target with its name, "vulkan:0"; null if there is none.
struct Named {
  std::string label;
  std::unique_ptr<Target> target;
};

/// The device of that name; where it is empty, the first that is a real GPU. Throws Error where it
/// cannot be opened.
Named vulkan_target(const std::string& name);
Named opencl_target(const std::string& name);

}  // namespace fathom::bench
