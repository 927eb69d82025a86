// SPDX-License-Identifier: Apache-2.0
// What is known of a device before it is opened.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backends/gpu/shape.hpp"
#include "backends/vulkan/api.hpp"
#include "engine/backend.hpp"

namespace fathom::vulkan {

struct PhysicalDevice {
  VkPhysicalDevice handle = VK_NULL_HANDLE;
  DeviceInfo info;
  gpu::Limits limits;
  VkPhysicalDeviceMemoryProperties memory = {};
  bool is_unified = false;  ///< Device and host share their memory: no copy in between.
  std::uint32_t compute_family = 0;
  /// A queue family that only copies, beside the computing; absent on many devices.
  std::optional<std::uint32_t> transfer_family;
  bool has_portability_subset = false;  ///< Then the extension must be asked for.
  std::string refusal;                  ///< Why it cannot be opened; empty if it can.
  std::string identity;                 ///< Device and driver: what a cache of its programs is for.
};

PhysicalDevice describe(VkPhysicalDevice handle);

/// Both of Vulkan's lists are asked twice: how many, then which.
template <class T, class Ask>
std::vector<T> list(const Ask& ask, const char* doing) {
  std::uint32_t count = 0;
  check(ask(&count, static_cast<T*>(nullptr)), doing);
  std::vector<T> items(count);
  if (count > 0) {
    const VkResult result = ask(&count, items.data());
    if (result != VK_INCOMPLETE) check(result, doing);
  }
  items.resize(count);
  return items;
}

bool has_extension(const std::vector<VkExtensionProperties>& extensions, std::string_view name);

}  // namespace fathom::vulkan
