// SPDX-License-Identifier: Apache-2.0
// An OpenCL object with one owner.
#pragma once

#include <utility>

#include "backends/opencl/api.hpp"

namespace fathom::opencl {

inline void release(cl_context object) { cl().ReleaseContext(object); }
inline void release(cl_command_queue object) { cl().ReleaseCommandQueue(object); }
inline void release(cl_mem object) { cl().ReleaseMemObject(object); }
inline void release(cl_program object) { cl().ReleaseProgram(object); }
inline void release(cl_kernel object) { cl().ReleaseKernel(object); }
inline void release(cl_event object) { cl().ReleaseEvent(object); }

/// Releases its object when it goes.
template <class T>
class Handle {
 public:
  Handle() = default;
  explicit Handle(T object) : object_(object) {}
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (object_ != nullptr) release(object_);
  }

  T get() const { return object_; }

 private:
  T object_ = nullptr;
};

}  // namespace fathom::opencl
