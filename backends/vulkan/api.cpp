// SPDX-License-Identifier: Apache-2.0
#define VOLK_IMPLEMENTATION
#include "backends/vulkan/api.hpp"

#include <fmt/format.h>

#include <mutex>

#include "engine/error.hpp"

#ifdef FATHOM_KEEP_LIBRARIES
// In place of the C library's where leaks are looked for: what a driver leaks can only be told from
// our own leaks while the driver is still loaded.
extern "C" int dlclose(void*) noexcept { return 0; }
#endif

namespace fathom::vulkan {
namespace {

struct Meaning {
  ErrorCode code;
  const char* text;
};

Meaning meaning_of(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return {ErrorCode::out_of_memory, "the computer is out of memory"};
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return {ErrorCode::out_of_memory, "the device is out of memory"};
    case VK_ERROR_TOO_MANY_OBJECTS:
      return {ErrorCode::out_of_memory, "the driver allows no more objects"};
    case VK_ERROR_DEVICE_LOST:
      return {ErrorCode::device_lost, "the device was lost; make a new plan"};
    case VK_ERROR_INITIALIZATION_FAILED:
      return {ErrorCode::unavailable, "the driver failed to start"};
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return {ErrorCode::unavailable, "no Vulkan driver on this machine"};
    default:
      return {ErrorCode::unavailable, "the driver refused"};
  }
}

}  // namespace

void require_loader() {
  // Never unloaded: drivers leave threads and exit handlers behind.
  static const VkResult found = volkInitialize();
  if (found != VK_SUCCESS) {
    throw Error(ErrorCode::unavailable, "no Vulkan loader (libvulkan.so.1) on this machine");
  }
}

void load_instance_functions(VkInstance instance) {
  static std::once_flag once;
  std::call_once(once, [&] { volkLoadInstanceOnly(instance); });
}

void check(VkResult result, const char* doing) {
  if (result == VK_SUCCESS) return;
  const Meaning meaning = meaning_of(result);
  throw Error(meaning.code, fmt::format("vulkan: {} failed: {} (VkResult {})", doing, meaning.text,
                                        static_cast<int>(result)));
}

}  // namespace fathom::vulkan
