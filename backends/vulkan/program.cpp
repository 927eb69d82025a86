// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/program.hpp"

#include <algorithm>
#include <cstring>

#include "backends/gpu/tables.hpp"

namespace fathom::vulkan {
namespace {

/// Scratch memory that keeps a large GPU busy with windows of 512, if it is no more than an eighth
/// of what it has.
constexpr std::uint64_t kScratchBytes = 256U << 20;

std::uint64_t scratch_room(const PhysicalDevice& physical) {
  std::uint64_t device_bytes = 0;
  for (std::uint32_t i = 0; i < physical.memory.memoryHeapCount; ++i) {
    device_bytes = std::max<std::uint64_t>(device_bytes, physical.memory.memoryHeaps[i].size);
  }
  return std::min({kScratchBytes, device_bytes / 8, physical.limits.buffer_bytes});
}

Constants constants_of(const MetricSpec& spec, const gpu::Shape& shape, Depth depth,
                       Program::Wanted wanted) {
  Constants constants = {};
  constants[FATHOM_WORKGROUP] = static_cast<std::uint32_t>(shape.threads);
  constants[FATHOM_N] = static_cast<std::uint32_t>(spec.n);
  constants[FATHOM_POINTS] = static_cast<std::uint32_t>(shape.points);
  constants[FATHOM_LINES] = static_cast<std::uint32_t>(shape.lines);
  constants[FATHOM_TEAMS] = static_cast<std::uint32_t>(shape.teams);
  // Of fft.comp alone: the others are the same for every taper, and compiled once.
  if (shape.kernel == gpu::Kernel::fft) {
    constants[FATHOM_TOUCHED] = static_cast<std::uint32_t>(gpu::touched_frequency(spec));
  }
  constants[FATHOM_POWER] = spec.power;
  constants[FATHOM_BANDED] = spec.band.has_value();
  constants[FATHOM_PLANES] = static_cast<std::uint32_t>(shape.planes);
  constants[FATHOM_IS_WALSH] = is_walsh(spec.transform);
  constants[FATHOM_BYTES] = static_cast<std::uint32_t>(bytes_per_pixel(depth));
  constants[FATHOM_PADDED] = shape.is_padded;
  constants[FATHOM_WANTED] = static_cast<std::uint32_t>(wanted);
  return constants;
}

Buffer tables_of(const Context& context, const MetricSpec& spec, gpu::Kernel kernel) {
  const auto words = gpu::table_words(spec, kernel);
  const std::size_t bytes = words.size() * sizeof words[0];
  Buffer buffer = context.buffer(bytes, Place::host_written, "a table");
  std::memcpy(buffer.mapped, words.data(), bytes);
  return buffer;
}

}  // namespace

Program::Program(Context& context, const MetricSpec& spec, const gpu::Shape& shape, Depth depth,
                 std::size_t capacity)
    : context_(context),
      spec_(spec),
      shape_(shape),
      depth_(depth),
      tables_(tables_of(context, spec, shape.kernel)),
      workgroups_(context.physical().limits.workgroups) {
  prepare(Wanted::score);
  if (shape.scratch_bytes == 0) return;
  const std::uint64_t most = scratch_room(context.physical()) / shape.scratch_bytes;
  workgroups_ = static_cast<std::uint32_t>(
      std::min<std::uint64_t>({std::max<std::uint64_t>(most, 1), capacity, workgroups_}));
  scratch_ = context.buffer(workgroups_ * shape.scratch_bytes, Place::device, "scratch memory");
}

void Program::prepare(Wanted wanted) {
  VkPipeline& pipeline = pipelines_[static_cast<int>(wanted)];
  if (pipeline != VK_NULL_HANDLE) return;
  pipeline = context_.pipeline(shape_.kernel, constants_of(spec_, shape_, depth_, wanted));
}

void Program::bind(VkCommandBuffer commands, VkDescriptorSet set, Wanted wanted) const {
  const DeviceApi& api = context_.api();
  api.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE,
                        pipelines_[static_cast<int>(wanted)]);
  api.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, context_.pipeline_layout(),
                              0, 1, &set, 0, nullptr);
}

void Program::record(VkCommandBuffer commands, VkDescriptorSet set, kernels::ScoreArgs args,
                     std::size_t windows, Wanted wanted) const {
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
  bind(commands, set, Wanted::score);
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
