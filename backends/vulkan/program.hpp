// SPDX-License-Identifier: Apache-2.0
// A kernel made ready for one metric: pipeline, tables and scratch memory.
#pragma once

#include "backends/vulkan/context.hpp"

namespace fathom::vulkan {

class Program {
 public:
  /// depth: of the pixels; exact.comp takes any. capacity: most windows of one call; scratch memory
  /// is for no more. Throws Error(out_of_memory, device_lost).
  Program(Context& context, const MetricSpec& spec, const gpu::Shape& shape, Depth depth,
          std::size_t capacity);

  const MetricSpec& spec() const { return spec_; }
  const gpu::Shape& shape() const { return shape_; }
  /// Tables, then scratch memory.
  VkBuffer work() const { return work_.buffer.get(); }
  /// False where a window fits on chip.
  bool has_scratch() const { return shape_.scratch_bytes > 0; }

  /// Compiles what that takes, where it was not before. Throws Error(out_of_memory, device_lost).
  void prepare(gpu::Wanted wanted);

  /// Scores windows 0 .. windows - 1 of what the descriptor set shows; args says the rest.
  void record(VkCommandBuffer commands, VkDescriptorSet set, kernels::ScoreArgs args,
              std::size_t windows, gpu::Wanted wanted) const;

  /// Scores the windows that an earlier program listed as doubtful.
  void record_doubtful(VkCommandBuffer commands, VkDescriptorSet set,
                       const kernels::ScoreArgs& args) const;

 private:
  void bind(VkCommandBuffer commands, VkDescriptorSet set, gpu::Wanted wanted) const;

  Context& context_;
  MetricSpec spec_;
  gpu::Shape shape_;
  Depth depth_;
  std::uint32_t workgroups_;  ///< Most in one dispatch.
  Buffer work_;
  /// By Wanted; that for coefficients only once somebody wants them.
  VkPipeline pipelines_[2] = {};
};

/// What a dispatch wrote is there for the next one.
void wait_for_shaders(const DeviceApi& api, VkCommandBuffer commands);

}  // namespace fathom::vulkan
