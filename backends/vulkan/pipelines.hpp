// SPDX-License-Identifier: Apache-2.0
// The kernels of a device, compiled once and kept on disk for the next process.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "backends/gpu/constants.hpp"
#include "backends/vulkan/handle.hpp"

namespace fathom::vulkan {

/// Safe to use from several threads. Must end before its device.
class Pipelines {
 public:
  /// Takes what an earlier process compiled for this identity (of device and driver) and these
  /// kernels, if the file cache has it.
  Pipelines(const DeviceApi& api, VkDevice device, std::string identity);
  /// Keeps what was compiled.
  ~Pipelines();
  Pipelines(const Pipelines&) = delete;
  Pipelines& operator=(const Pipelines&) = delete;

  VkDescriptorSetLayout set_layout() const { return set_layout_.get(); }
  VkPipelineLayout layout() const { return layout_.get(); }

  /// A kernel compiled with these constants; the same for everybody who asks. Throws
  /// Error(device_lost, out_of_memory).
  VkPipeline get(gpu::Kernel kernel, const gpu::Constants& constants);

 private:
  Handle<VkShaderModule> module(gpu::Kernel kernel) const;
  Handle<VkPipelineCache> open_cache(std::string_view data) const;
  std::string file_name() const;
  void keep();
  void try_to_keep() noexcept;

  const DeviceApi& api_;
  VkDevice device_;
  std::string identity_;
  Handle<VkDescriptorSetLayout> set_layout_;
  Handle<VkPipelineLayout> layout_;
  std::mutex mutex_;
  Handle<VkPipelineCache> cache_;
  std::map<std::pair<gpu::Kernel, gpu::Constants>, Handle<VkPipeline>> pipelines_;
  double unkept_s_ = 0;  ///< Time that went into compiling what is not on disk yet.
};

}  // namespace fathom::vulkan
