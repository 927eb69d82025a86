// SPDX-License-Identifier: Apache-2.0
// VkFFT's batched real 2-D transform of N x N on a Vulkan device, in place, and nothing else.
#pragma once

#include <memory>

#include "backends/vulkan/context.hpp"

namespace fathom::bench {

class VulkanFft {
 public:
  virtual ~VulkanFft() = default;
  VulkanFft(const VulkanFft&) = delete;
  VulkanFft& operator=(const VulkanFft&) = delete;

  /// To be recorded between barriers: the batch is transformed where it lies. Throws
  /// std::runtime_error.
  virtual void record(VkCommandBuffer commands) = 0;

 protected:
  VulkanFft() = default;
};

/// data: [window][N][N/2 + 1] complex numbers, or in their place N floats a row. It and the context
/// must outlive the transform; no other device may be open for VkFFT. Throws std::runtime_error.
std::unique_ptr<VulkanFft> make_vulkan_fft(const vulkan::Context& context, int n, std::size_t batch,
                                           const vulkan::Buffer& data);

}  // namespace fathom::bench
