// SPDX-License-Identifier: Apache-2.0
#include "backends/opencl/context.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "backends/gpu/no_memory.hpp"
#include "engine/error.hpp"

namespace fathom::opencl {
namespace {

Handle<cl_context> open(const PhysicalDevice& physical) {
  if (!physical.refusal.empty()) throw Error(ErrorCode::unavailable, physical.refusal);
  const cl_context_properties properties[] = {
      CL_CONTEXT_PLATFORM, reinterpret_cast<cl_context_properties>(physical.platform), 0};
  cl_int result = CL_SUCCESS;
  Handle<cl_context> context(
      cl().CreateContext(properties, 1, &physical.id, nullptr, nullptr, &result));
  check(result, "opening the device");
  return context;
}

Handle<cl_command_queue> make_queue(cl_context context, cl_device_id device) {
  cl_int result = CL_SUCCESS;
  Handle<cl_command_queue> queue(cl().CreateCommandQueue(context, device, 0, &result));
  check(result, "a queue");
  return queue;
}

/// Of a command or a wait. What a kernel does wrong, and a watchdog, comes as CL_OUT_OF_RESOURCES
/// from some drivers, as numbers of their own from others.
bool means_lost(cl_int result) {
  constexpr cl_int kLastOfKhronos = -1000;
  switch (result) {
    case CL_DEVICE_NOT_AVAILABLE:
    case CL_OUT_OF_RESOURCES:
    case CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST:
    case CL_INVALID_COMMAND_QUEUE:
    case CL_INVALID_CONTEXT:
      return true;
    default:
      return result < kLastOfKhronos;
  }
}

/// Looks again soon after a short wait, seldom in a long one: a score comes at most a thirtieth
/// later than it could.
void pause_after(std::chrono::steady_clock::duration waited) {
  constexpr std::chrono::microseconds kShort(100);
  constexpr std::chrono::steady_clock::duration kLongest = std::chrono::milliseconds(5);
  if (waited < kShort) return std::this_thread::yield();
  std::this_thread::sleep_for(std::min(waited / 32, kLongest));
}

}  // namespace

Context::Context(const PhysicalDevice& physical)
    : physical_(physical),
      context_(open(physical)),
      queue_(make_queue(context_.get(), physical.id)),
      copies_(make_queue(context_.get(), physical.id)),
      programs_(std::make_unique<Programs>(context_.get(), physical)),
      wait_limit_(physical.info.kind) {}

Context::~Context() {
  drain();
  if (!is_given_up_) return;
  gpu::keep_for_ever(std::move(programs_));
  for (auto* queue : {&queue_, &copies_}) {
    gpu::keep_for_ever(std::make_shared<Handle<cl_command_queue>>(std::move(*queue)));
  }
  gpu::keep_for_ever(std::make_shared<Handle<cl_context>>(std::move(context_)));
}

Handle<cl_kernel> Context::kernel(gpu::Kernel kernel, const gpu::Constants& constants) {
  const cl_program program = programs_->get(kernel, constants);
  cl_int result = CL_SUCCESS;
  Handle<cl_kernel> made(cl().CreateKernel(program, kernel_name(kernel), &result));
  check(result, "a kernel");
  return made;
}

Buffer Context::buffer(std::size_t bytes, cl_mem_flags flags, const char* what) const {
  cl_int result = CL_SUCCESS;
  Buffer buffer;
  buffer.bytes = bytes;
  buffer.memory = Handle<cl_mem>(cl().CreateBuffer(context_.get(), flags, bytes, nullptr, &result));
  if (const char* const fault = memory_fault(result)) {
    throw gpu::no_memory(physical_.info.name, bytes, what,
                         fmt::format("opencl: {} (error {})", fault, result));
  }
  check(result, "a buffer");
  return buffer;
}

void Context::check_alive(cl_int result, const char* doing) {
  if (result == CL_SUCCESS) return;
  if (means_lost(result)) {
    is_lost_ = true;
    throw Error(ErrorCode::device_lost,
                fmt::format("opencl: {} failed: the device was lost; make a new plan (error {})",
                            doing, result));
  }
  // Drivers allocate when memory is used first, so that it may come to this here.
  if (const char* const fault = memory_fault(result)) {
    throw Error(ErrorCode::out_of_memory,
                fmt::format("{}: {} failed: {} (error {}); try a smaller capacity, or pictures of "
                            "fewer pixels",
                            physical_.info.name, doing, fault, result));
  }
  check(result, doing);
}

void Context::wait(cl_event event, std::size_t windows) {
  if (is_given_up_) require_alive();  // nobody waits for it twice
  const double limit_s = wait_limit_.seconds(windows);
  const auto start = std::chrono::steady_clock::now();
  // OpenCL's own wait has no limit.
  for (;;) {
    cl_int status = CL_QUEUED;
    check_alive(cl().GetEventInfo(event, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status,
                                  nullptr),
                "waiting for the device");
    if (status < 0) check_alive(status, "waiting for the device");
    if (status == CL_COMPLETE) return;
    const auto waited = std::chrono::steady_clock::now() - start;
    if (std::chrono::duration<double>(waited).count() > limit_s) break;
    pause_after(waited);
  }
  is_lost_ = is_given_up_ = true;
  throw gpu::given_up(physical_.info.name, limit_s);
}

void Context::drain() noexcept {
  if (is_given_up_) return;
  for (const auto* queue : {&copies_, &queue_}) {
    if (queue->get() != nullptr) cl().Finish(queue->get());
  }
}

void Context::require_alive() const {
  if (is_lost_)
    throw Error(ErrorCode::device_lost, physical_.info.name + " was lost; make a new plan");
}

}  // namespace fathom::opencl
