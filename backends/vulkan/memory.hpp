// SPDX-License-Identifier: Apache-2.0
// Buffers: memory that kernels see as one array, and that the host sees too if it is mapped.
#pragma once

#include "backends/vulkan/handle.hpp"
#include "backends/vulkan/physical.hpp"

namespace fathom::vulkan {

struct Buffer {
  Handle<VkDeviceMemory> memory;
  Handle<VkBuffer> buffer;  // after its memory, so that it goes first
  VkDeviceSize bytes = 0;
  void* mapped = nullptr;
};

/// Where a buffer should live.
enum class Place {
  device,          ///< On the device; the host does not look.
  upload,          ///< The host writes, the device copies.
  device_written,  ///< The device writes, the host reads.
  host_written,    ///< The host writes, the device reads: on the device where the host reaches it.
};

/// Throws Error(out_of_memory) saying how much was wanted and for what; then nothing is kept.
Buffer make_buffer(const DeviceApi& api, VkDevice device, const PhysicalDevice& physical,
                   VkDeviceSize bytes, Place place, const char* what);

}  // namespace fathom::vulkan
