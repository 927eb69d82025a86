// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "backends/vulkan/context.hpp"

namespace fathom::vulkan {

/// Commands of one queue family, recorded again for every batch.
class Commands {
 public:
  Commands(const Context& context, std::uint32_t queue_family);
  VkCommandBuffer begin() const;
  void end() const;

 private:
  const Context& context_;
  Handle<VkCommandPool> pool_;
  VkCommandBuffer buffer_ = VK_NULL_HANDLE;  // of the pool
};

/// What `from` wrote is there for `to`.
void barrier(const DeviceApi& api, VkCommandBuffer commands, VkPipelineStageFlags from,
             VkAccessFlags written, VkPipelineStageFlags to, VkAccessFlags wanted);

/// Writes words to the start of a buffer. Returns when kernels see them. Throws
/// Error(out_of_memory, device_lost, timeout); after that the buffer is kept with the rest.
void write_start(Context& context, Buffer& buffer, std::span<const std::uint32_t> words);

}  // namespace fathom::vulkan
