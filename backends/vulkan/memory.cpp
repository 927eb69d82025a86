// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/memory.hpp"

#include <algorithm>
#include <vector>

#include "backends/gpu/no_memory.hpp"

namespace fathom::vulkan {
namespace {

constexpr VkMemoryPropertyFlags kOnDevice = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
constexpr VkMemoryPropertyFlags kMapped =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

struct Wish {
  VkMemoryPropertyFlags needed, liked;
};

Wish wish_for(Place place) {
  switch (place) {
    case Place::device:
      return {0, kOnDevice};
    case Place::upload:
      return {kMapped, 0};
    case Place::device_written:
      return {kMapped, VK_MEMORY_PROPERTY_HOST_CACHED_BIT};
    case Place::host_written:
      return {kMapped, kOnDevice};
  }
  return {};
}

/// The memory types that have all that is needed, first those with what is liked.
std::vector<std::uint32_t> memory_types(const VkPhysicalDeviceMemoryProperties& memory,
                                        std::uint32_t allowed, const Wish& wish) {
  std::vector<std::uint32_t> types;
  for (const VkMemoryPropertyFlags wanted : {wish.needed | wish.liked, wish.needed}) {
    for (std::uint32_t type = 0; type < memory.memoryTypeCount; ++type) {
      const bool is_allowed = (allowed & (1U << type)) != 0;
      const bool has_all = (memory.memoryTypes[type].propertyFlags & wanted) == wanted;
      const bool is_new = std::find(types.begin(), types.end(), type) == types.end();
      if (is_allowed && has_all && is_new) types.push_back(type);
    }
  }
  if (types.empty()) throw Error(ErrorCode::unavailable, "the driver has no memory of that kind");
  return types;
}

/// From the first type that has so much left: the part of a card's memory that the host reaches is
/// often small.
Handle<VkDeviceMemory> allocate(const DeviceApi& api, VkDevice device, VkDeviceSize bytes,
                                const std::vector<std::uint32_t>& types) {
  VkResult result = VK_SUCCESS;
  for (const std::uint32_t type : types) {
    VkMemoryAllocateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    info.allocationSize = bytes;
    info.memoryTypeIndex = type;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    result = api.vkAllocateMemory(device, &info, nullptr, &memory);
    if (result == VK_SUCCESS) return {device, memory, api.vkFreeMemory};
    if (result != VK_ERROR_OUT_OF_DEVICE_MEMORY) break;
  }
  check(result, "memory");
  return {};
}

VkBufferCreateInfo buffer_info(VkDeviceSize bytes, const std::uint32_t (&families)[2],
                               bool is_shared) {
  VkBufferCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = bytes;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
               VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  if (is_shared) {
    info.sharingMode = VK_SHARING_MODE_CONCURRENT;
    info.queueFamilyIndexCount = 2;
    info.pQueueFamilyIndices = families;
  }
  return info;
}

Buffer try_buffer(const DeviceApi& api, VkDevice device, const PhysicalDevice& physical,
                  VkDeviceSize bytes, Place place) {
  const std::uint32_t families[2] = {physical.compute_family, physical.transfer_family.value_or(0)};
  const VkBufferCreateInfo info =
      buffer_info(bytes, families, physical.transfer_family.has_value());
  Buffer made;
  made.bytes = bytes;
  VkBuffer buffer = VK_NULL_HANDLE;
  check(api.vkCreateBuffer(device, &info, nullptr, &buffer), "a buffer");
  made.buffer = {device, buffer, api.vkDestroyBuffer};
  VkMemoryRequirements needs = {};
  api.vkGetBufferMemoryRequirements(device, buffer, &needs);
  made.memory = allocate(api, device, needs.size,
                         memory_types(physical.memory, needs.memoryTypeBits, wish_for(place)));
  const VkDeviceMemory memory = made.memory.get();
  check(api.vkBindBufferMemory(device, buffer, memory, 0), "binding memory");
  if (place != Place::device) {
    check(api.vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, &made.mapped), "mapping memory");
  }
  return made;
}

}  // namespace

Buffer make_buffer(const DeviceApi& api, VkDevice device, const PhysicalDevice& physical,
                   VkDeviceSize bytes, Place place, const char* what) {
  try {
    return try_buffer(api, device, physical, bytes, place);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::out_of_memory) throw;
    throw gpu::no_memory(physical.info.name, bytes, what, error.what());
  }
}

}  // namespace fathom::vulkan
