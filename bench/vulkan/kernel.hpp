// SPDX-License-Identifier: Apache-2.0
// A kernel of a peer, with the buffers that it works on.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "backends/vulkan/context.hpp"

namespace fathom::bench {

/// Reads its push constants as these two; a kernel may declare fewer.
struct KernelArgs {
  std::uint32_t windows = 0, stride = 0;
};

/// Takes N as constant 0. Its buffers are bound in the order of their bindings.
class VulkanKernel {
 public:
  /// Throws Error.
  VulkanKernel(const vulkan::Context& context, std::span<const std::uint32_t> spirv,
               std::uint32_t n, std::uint32_t buffers);

  /// Not while the device works with what was bound before.
  void bind(std::initializer_list<const vulkan::Buffer*> buffers);

  void record(VkCommandBuffer commands, const KernelArgs& args, std::uint32_t workgroups) const;

 private:
  const vulkan::Context& context_;
  vulkan::Handle<VkDescriptorSetLayout> set_layout_;
  vulkan::Handle<VkPipelineLayout> layout_;
  vulkan::Handle<VkPipeline> pipeline_;
  vulkan::Handle<VkDescriptorPool> pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;  // of the pool
};

}  // namespace fathom::bench
