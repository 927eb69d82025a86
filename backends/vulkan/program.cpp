// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/program.hpp"

#include <algorithm>

#include "backends/gpu/tables.hpp"
#include "backends/vulkan/commands.hpp"

namespace fathom::vulkan {
namespace {

std::uint64_t table_bytes(const MetricSpec& spec) {
  return FATHOM_TABLE_BYTES(static_cast<std::uint64_t>(spec.n));
}

/// Workgroups for which there is scratch memory behind the tables.
std::uint32_t workgroups_for(const MetricSpec& spec, const gpu::Shape& shape, gpu::Limits limits,
                             std::size_t windows) {
  limits.buffer_bytes -= std::min(limits.buffer_bytes, table_bytes(spec));
  return gpu::workgroups_of(shape, limits, windows);
}

}  // namespace

Program::Program(Context& context, const MetricSpec& spec, const gpu::Shape& shape, Depth depth,
                 std::size_t capacity)
    : context_(context),
      spec_(spec),
      shape_(shape),
      depth_(depth),
      workgroups_(workgroups_for(spec, shape, context.limits(), capacity)) {
  prepare(gpu::Wanted::score);
  work_ = context.buffer(table_bytes(spec) + workgroups_ * shape.scratch_bytes, Place::device,
                         "scratch memory");
  write_start(context, work_, gpu::table_words(spec, shape.kernel));
}

void Program::prepare(gpu::Wanted wanted) {
  VkPipeline& pipeline = pipelines_[static_cast<int>(wanted)];
  if (pipeline != VK_NULL_HANDLE) return;
  pipeline = context_.pipeline(shape_.kernel, gpu::constants_of(spec_, shape_, depth_, wanted));
}

void Program::bind(VkCommandBuffer commands, VkDescriptorSet set, gpu::Wanted wanted) const {
  const DeviceApi& api = context_.api();
  api.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE,
                        pipelines_[static_cast<int>(wanted)]);
  api.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, context_.pipeline_layout(),
                              0, 1, &set, 0, nullptr);
}

void Program::record(VkCommandBuffer commands, VkDescriptorSet set, kernels::ScoreArgs args,
                     std::size_t windows, gpu::Wanted wanted) const {
  const DeviceApi& api = context_.api();
  bind(commands, set, wanted);
  const std::size_t most = std::size_t{workgroups_} * shape_.teams;
  for (std::size_t first = 0; first < windows; first += most) {
    if (first > 0 && shape_.scratch_bytes > 0) wait_for_shaders(api, commands);  // scratch is free
    args.first_window = static_cast<std::uint32_t>(first);
    args.windows = static_cast<std::uint32_t>(std::min(most, windows - first));
    api.vkCmdPushConstants(commands, context_.pipeline_layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                           sizeof args, &args);
    const auto teams = static_cast<std::uint32_t>(shape_.teams);
    api.vkCmdDispatch(commands, (args.windows + teams - 1) / teams, 1, 1);
  }
}

void Program::record_doubtful(VkCommandBuffer commands, VkDescriptorSet set,
                              const kernels::ScoreArgs& args) const {
  const DeviceApi& api = context_.api();
  bind(commands, set, gpu::Wanted::score);
  api.vkCmdPushConstants(commands, context_.pipeline_layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                         sizeof args, &args);
  api.vkCmdDispatch(commands, workgroups_, 1, 1);
}

void wait_for_shaders(const DeviceApi& api, VkCommandBuffer commands) {
  VkMemoryBarrier barrier = {};
  barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  barrier.srcAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT;
  api.vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                           VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 1, &barrier, 0, nullptr, 0,
                           nullptr);
}

}  // namespace fathom::vulkan
