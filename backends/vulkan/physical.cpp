// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/physical.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "engine/cache.hpp"

namespace fathom::vulkan {
namespace {

struct Properties {
  VkPhysicalDeviceProperties core = {};
  VkPhysicalDeviceSubgroupProperties subgroup = {};
  VkPhysicalDeviceDriverProperties driver = {};
};

Properties properties_of(VkPhysicalDevice handle, bool names_driver) {
  Properties properties;
  properties.driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  properties.subgroup.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES;
  if (names_driver) properties.subgroup.pNext = &properties.driver;
  VkPhysicalDeviceProperties2 all = {};
  all.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  all.pNext = &properties.subgroup;
  vkGetPhysicalDeviceProperties2(handle, &all);
  properties.core = all.properties;
  return properties;
}

DeviceKind kind_of(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return DeviceKind::gpu;
    default:
      return DeviceKind::software;
  }
}

const char* type_name(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated GPU";
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete GPU";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual GPU";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "software rasteriser";
    default:
      return "unknown type";
  }
}

gpu::Limits limits_of(const Properties& properties) {
  const VkPhysicalDeviceLimits& core = properties.core.limits;
  gpu::Limits limits;
  limits.shared_bytes = core.maxComputeSharedMemorySize;
  limits.threads = std::min(core.maxComputeWorkGroupInvocations, core.maxComputeWorkGroupSize[0]);
  limits.workgroups = core.maxComputeWorkGroupCount[0];
  limits.buffer_bytes = core.maxStorageBufferRange;
  limits.subgroup = std::max(properties.subgroup.subgroupSize, 1U);
  limits.storage_buffers = core.maxPerStageDescriptorStorageBuffers;
  // Only these have registers for a whole line of 64: others would spill. A processor has sixteen,
  // and its compiler takes minutes for what is unrolled further.
  constexpr std::uint32_t kNvidia = 0x10de, kAmd = 0x1002;
  const bool has_registers =
      properties.core.vendorID == kNvidia || properties.core.vendorID == kAmd;
  limits.points = has_registers ? 64 : 16;
  return limits;
}

std::string driver_of(const Properties& properties) {
  if (properties.driver.driverName[0] == '\0') {
    return fmt::format("driver {}", properties.core.driverVersion);
  }
  return fmt::format("{} {}", properties.driver.driverName, properties.driver.driverInfo);
}

std::string details_of(const Properties& properties, const gpu::Limits& limits) {
  const std::uint32_t version = properties.core.apiVersion;
  return fmt::format(
      "{}, Vulkan {}.{}.{}, {}, {} KiB shared, {} threads, subgroups of {}, {} MiB a buffer",
      type_name(properties.core.deviceType), VK_API_VERSION_MAJOR(version),
      VK_API_VERSION_MINOR(version), VK_API_VERSION_PATCH(version), driver_of(properties),
      limits.shared_bytes / 1024, limits.threads, limits.subgroup, limits.buffer_bytes >> 20);
}

std::string identity_of(const Properties& properties) {
  std::string text = fmt::format("{:04x}-{:04x}-{:08x}-", properties.core.vendorID,
                                 properties.core.deviceID, properties.core.driverVersion);
  for (const std::uint8_t byte : properties.core.pipelineCacheUUID) {
    text += fmt::format("{:02x}", byte);
  }
  // Some drivers have neither a version nor a cache's number of their own.
  const std::string names = fmt::format("{}\n{}\n{}", properties.core.deviceName,
                                        properties.driver.driverName, properties.driver.driverInfo);
  return text + fmt::format("-{:016x}", hash_of(names));
}

void find_queues(PhysicalDevice& device) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device.handle, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device.handle, &count, families.data());
  bool computes = false;
  for (std::uint32_t family = 0; family < families.size(); ++family) {
    const VkQueueFlags flags = families[family].queueFlags;
    const bool is_for_compute = (flags & VK_QUEUE_COMPUTE_BIT) != 0;
    const VkQueueFlags others =
        flags & ~static_cast<VkQueueFlags>(VK_QUEUE_TRANSFER_BIT | VK_QUEUE_SPARSE_BINDING_BIT);
    if (is_for_compute && !computes) {
      device.compute_family = family;
      computes = true;
    } else if (others == 0 && (flags & VK_QUEUE_TRANSFER_BIT) != 0 && !device.transfer_family) {
      device.transfer_family = family;
    }
  }
  if (!computes) device.refusal = "it has no compute queue";
}

bool shares_memory(const VkPhysicalDeviceMemoryProperties& memory, VkPhysicalDeviceType type) {
  if (type != VK_PHYSICAL_DEVICE_TYPE_CPU && type != VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU) {
    return false;
  }
  constexpr VkMemoryPropertyFlags kBoth = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT |
                                          VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                          VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  const auto* const types = memory.memoryTypes;
  return std::any_of(types, types + memory.memoryTypeCount, [](const VkMemoryType& each) {
    return (each.propertyFlags & kBoth) == kBoth;
  });
}

}  // namespace

bool has_extension(const std::vector<VkExtensionProperties>& extensions, std::string_view name) {
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& extension) { return name == extension.extensionName; });
}

PhysicalDevice describe(VkPhysicalDevice handle) {
  const auto extensions = list<VkExtensionProperties>(
      [&](auto* count, auto* items) {
        return vkEnumerateDeviceExtensionProperties(handle, nullptr, count, items);
      },
      "listing extensions");
  const Properties properties =
      properties_of(handle, has_extension(extensions, VK_KHR_DRIVER_PROPERTIES_EXTENSION_NAME));
  PhysicalDevice device;
  device.handle = handle;
  device.limits = limits_of(properties);
  device.info = {properties.core.deviceName, kind_of(properties.core.deviceType),
                 details_of(properties, device.limits)};
  device.has_portability_subset = has_extension(extensions, "VK_KHR_portability_subset");
  device.identity = identity_of(properties);
  vkGetPhysicalDeviceMemoryProperties(handle, &device.memory);
  const VkMemoryHeap* const heaps = device.memory.memoryHeaps;
  device.limits.device_bytes = 0;
  for (std::uint32_t i = 0; i < device.memory.memoryHeapCount; ++i) {
    device.limits.device_bytes = std::max<std::uint64_t>(device.limits.device_bytes, heaps[i].size);
  }
  device.is_unified = shares_memory(device.memory, properties.core.deviceType);
  find_queues(device);
  if (properties.core.apiVersion < VK_API_VERSION_1_1) {
    device.refusal = "its driver is older than Vulkan 1.1";
  }
  return device;
}

}  // namespace fathom::vulkan
