// SPDX-License-Identifier: Apache-2.0
#include "backends/opencl/api.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <optional>
#include <string>

#include "engine/error.hpp"

namespace fathom::opencl {
namespace {

constexpr cl_int kNoPlatform = -1001;  // CL_PLATFORM_NOT_FOUND_KHR, of the loader

/// Nothing where there is no loader, or one without OpenCL 1.2.
std::optional<Api> load() {
  // Never unloaded: drivers leave threads and exit handlers behind.
  void* library = nullptr;
  for (const char* name : {"libOpenCL.so.1", "libOpenCL.so"}) {
    if (library == nullptr) library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
  }
  if (library == nullptr) return std::nullopt;
  Api api;
  bool is_whole = true;
  const auto find = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
    is_whole = is_whole && function != nullptr;
  };
#define FATHOM_OPENCL_FIND(name) find(api.name, "cl" #name);
  FATHOM_OPENCL_FUNCTIONS(FATHOM_OPENCL_FIND)
#undef FATHOM_OPENCL_FIND
  return is_whole ? std::optional(api) : std::nullopt;
}

struct Meaning {
  ErrorCode code;
  const char* text;
};

Meaning meaning_of(cl_int result) {
  if (const char* const fault = memory_fault(result)) return {ErrorCode::out_of_memory, fault};
  switch (result) {
    case CL_INVALID_WORK_GROUP_SIZE:
      // CL_KERNEL_WORK_GROUP_SIZE would say so beforehand, but not rightly in Mesa 22.
      return {ErrorCode::unsupported,
              "the kernel gets fewer threads than the device has for others"};
    case CL_DEVICE_NOT_AVAILABLE:
      return {ErrorCode::unavailable, "the device is not available now"};
    case CL_DEVICE_NOT_FOUND:
      return {ErrorCode::unavailable, "no such device"};
    case kNoPlatform:
      return {ErrorCode::unavailable, "no OpenCL driver on this machine"};
    default:
      return {ErrorCode::unavailable, "the driver refused"};
  }
}

}  // namespace

const Api& cl() {
  static const std::optional<Api> api = load();
  if (!api) {
    throw Error(ErrorCode::unavailable,
                "no OpenCL loader (libOpenCL.so.1, of OpenCL 1.2 or later) on this machine");
  }
  return *api;
}

const char* memory_fault(cl_int result) {
  switch (result) {
    case CL_OUT_OF_HOST_MEMORY:
      return "the computer is out of memory";
    case CL_MEM_OBJECT_ALLOCATION_FAILURE:
    case CL_MAP_FAILURE:
    case CL_OUT_OF_RESOURCES:
      return "the device is out of memory";
    case CL_INVALID_BUFFER_SIZE:
      return "that is more than its driver allows";
    default:
      return nullptr;
  }
}

void check(cl_int result, const char* doing) {
  if (result == CL_SUCCESS) return;
  const Meaning meaning = meaning_of(result);
  throw Error(meaning.code,
              fmt::format("opencl: {} failed: {} (error {})", doing, meaning.text, result));
}

}  // namespace fathom::opencl
