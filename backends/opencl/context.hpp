// SPDX-License-Identifier: Apache-2.0
// An opened device: its queues, its memory and the kernels that plans share.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "backends/gpu/wait_limit.hpp"
#include "backends/opencl/handle.hpp"
#include "backends/opencl/physical.hpp"
#include "backends/opencl/programs.hpp"

namespace fathom::opencl {

/// Memory that kernels see as one array.
struct Buffer {
  Handle<cl_mem> memory;
  std::size_t bytes = 0;
};

/// Safe to use from several threads, but for what a plan owns.
class Context {
 public:
  /// Throws Error(unavailable).
  explicit Context(const PhysicalDevice& physical);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const PhysicalDevice& physical() const { return physical_; }
  const gpu::Limits& limits() const { return physical_.limits; }

  /// What computes, in the order of its commands.
  cl_command_queue queue() const { return queue_.get(); }
  /// What copies to the device, at the same time.
  cl_command_queue copies() const { return copies_.get(); }

  /// A kernel of the caller's own; compiled once with these constants for every plan that asks.
  Handle<cl_kernel> kernel(gpu::Kernel kernel, const gpu::Constants& constants);

  /// flags: how kernels and the host use it. Throws Error(out_of_memory) saying how much was wanted
  /// and for what.
  Buffer buffer(std::size_t bytes, cl_mem_flags flags, const char* what) const;

  /// For results of commands and waits. Throws Error(out_of_memory); Error(device_lost) for what a
  /// device says that is gone or whose kernel failed; Error(unavailable) for all else.
  void check_alive(cl_int result, const char* doing);

  /// Waits for a command that was flushed; windows: of its batch. Throws as check_alive does, and
  /// Error(timeout) where the device takes longer than it may (gpu::WaitLimit): then it is lost and
  /// given up.
  void wait(cl_event event, std::size_t windows);

  /// Waits for everything, whatever comes of it, unless the device was given up: for destructors
  /// and unwinding.
  void drain() noexcept;

  /// Whether the device was lost: then every call fails, and only a new Context helps.
  bool is_lost() const { return is_lost_; }
  /// Whether it may still be at work: then what it was given must never go (gpu::keep_for_ever).
  bool is_given_up() const { return is_given_up_; }
  /// Throws Error(device_lost) if it was.
  void require_alive() const;

 private:
  PhysicalDevice physical_;
  Handle<cl_context> context_;
  Handle<cl_command_queue> queue_, copies_;
  std::unique_ptr<Programs> programs_;
  gpu::WaitLimit wait_limit_;
  std::atomic<bool> is_lost_ = false, is_given_up_ = false;
};

}  // namespace fathom::opencl
