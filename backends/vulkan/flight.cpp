// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/flight.hpp"

#include <algorithm>

#include "backends/gpu/spectrum.hpp"

namespace fathom::vulkan {
namespace {

Handle<VkDescriptorPool> descriptor_pool(const Context& context, std::uint32_t sets) {
  const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, sets * FATHOM_BINDINGS};
  VkDescriptorPoolCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  info.maxSets = sets;
  info.poolSizeCount = 1;
  info.pPoolSizes = &size;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  check(context.api().vkCreateDescriptorPool(context.device(), &info, nullptr, &pool),
        "a descriptor pool");
  return {context.device(), pool, context.api().vkDestroyDescriptorPool};
}

}  // namespace

Flight::Flight(Context& context, std::size_t windows, std::size_t words)
    : context_(context),
      done_(context.fence()),
      uploaded_(context.has_transfer_queue() ? context.semaphore() : Handle<VkSemaphore>()),
      compute_(context, context.physical().compute_family),
      transfer_(context,
                context.physical().transfer_family.value_or(context.physical().compute_family)),
      descriptor_pool_(descriptor_pool(context, 2)),
      scores_(context.buffer(4 * words * windows, Place::device_written, "scores")),
      doubtful_(context.buffer(4 + 4 * windows, Place::device, "a list of doubtful windows")) {
  const VkDescriptorSetLayout layouts[2] = {context.set_layout(), context.set_layout()};
  VkDescriptorSetAllocateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  info.descriptorPool = descriptor_pool_.get();
  info.descriptorSetCount = 2;
  info.pSetLayouts = layouts;
  check(context.api().vkAllocateDescriptorSets(context.device(), &info, sets_), "descriptor sets");
}

void Flight::load(const Frame& frame, const gpu::Rectangle& part, std::span<const Window> windows,
                  std::span<const std::uint32_t> ids) {
  windows_ = ids.empty() ? windows.size() : ids.size();
  const std::size_t list_bytes = 4 * windows_, bytes = list_bytes + part.bytes(frame.depth());
  const bool is_unified = context_.physical().is_unified;
  if (bytes > frame_.bytes) {
    // First both, then in their place: if the second does not fit, the flight is as it was.
    Buffer staging;
    if (!is_unified) staging = context_.buffer(bytes, Place::upload, "a frame to upload");
    frame_ = context_.buffer(bytes, is_unified ? Place::host_written : Place::device, "a frame");
    staging_ = std::move(staging);
  }
  frame_bytes_ = bytes;
  depth_ = frame.depth();
  is_uploaded_ = false;
  stride_words_ = static_cast<std::uint32_t>(part.stride_bytes(depth_) / 4);
  auto* const mapped = static_cast<std::byte*>(is_unified ? frame_.mapped : staging_.mapped);
  auto* const origins = reinterpret_cast<std::uint32_t*>(mapped);
  for (std::size_t i = 0; i < windows_; ++i) {
    origins[i] = static_cast<std::uint32_t>(list_bytes) +
                 part.origin(windows[ids.empty() ? i : ids[i]], depth_);
  }
  part.copy(frame, mapped + list_bytes);
}

void Flight::show(VkDescriptorSet set, const Program& program, gpu::Wanted wanted) const {
  VkBuffer buffers[FATHOM_BINDINGS] = {};
  buffers[FATHOM_BINDING_FRAME] = frame_.buffer.get();
  buffers[FATHOM_BINDING_RESULTS] =
      wanted == gpu::Wanted::score ? scores_.buffer.get() : spectrum_.buffer.get();
  buffers[FATHOM_BINDING_WORK] = program.work();
  buffers[FATHOM_BINDING_DOUBTFUL] = doubtful_.buffer.get();
  VkDescriptorBufferInfo infos[FATHOM_BINDINGS] = {};
  VkWriteDescriptorSet writes[FATHOM_BINDINGS] = {};
  for (std::uint32_t i = 0; i < FATHOM_BINDINGS; ++i) {
    infos[i] = {buffers[i], 0, VK_WHOLE_SIZE};
    writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    writes[i].dstSet = set;
    writes[i].dstBinding = i;
    writes[i].descriptorCount = 1;
    writes[i].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    writes[i].pBufferInfo = &infos[i];
  }
  context_.api().vkUpdateDescriptorSets(context_.device(), FATHOM_BINDINGS, writes, 0, nullptr);
}

void Flight::record_copy(VkCommandBuffer commands) const {
  const VkBufferCopy region = {0, 0, frame_bytes_};
  context_.api().vkCmdCopyBuffer(commands, staging_.buffer.get(), frame_.buffer.get(), 1, &region);
}

void Flight::record(VkCommandBuffer commands, const Program& program, const Program* rescue,
                    kernels::ScoreArgs args, gpu::Wanted wanted) const {
  const DeviceApi& api = context_.api();
  args.stride_words = stride_words_;
  args.bytes_per_pixel = static_cast<std::uint32_t>(bytes_per_pixel(depth_));
  api.vkCmdFillBuffer(commands, doubtful_.buffer.get(), 0, 4, 0);
  barrier(api, commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
          VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
          VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
  // The other flight uses the same scratch memory; the rescue's own waits further down.
  if (program.has_scratch()) wait_for_shaders(api, commands);
  program.record(commands, sets_[0], args, windows_, wanted);
  if (rescue != nullptr) {
    wait_for_shaders(api, commands);
    rescue->record_doubtful(commands, sets_[1], args);
  }
  barrier(api, commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
          VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
}

void Flight::start(const Program& program, const Program* rescue, const kernels::ScoreArgs& args,
                   gpu::Wanted wanted) {
  if (wanted == gpu::Wanted::coefficients && spectrum_.bytes == 0) {
    spectrum_ = context_.buffer(sizeof(std::uint32_t) * gpu::spectrum_words(program.spec().n),
                                Place::device_written, "a spectrum");
  }
  show(sets_[0], program, wanted);
  if (rescue != nullptr) show(sets_[1], *rescue, wanted);
  const bool is_separate = must_upload() && context_.has_transfer_queue();
  const VkCommandBuffer commands = compute_.begin();
  if (must_upload() && !is_separate) record_copy(commands);
  record(commands, program, rescue, args, wanted);
  compute_.end();
  if (is_separate) {
    const VkCommandBuffer copy = transfer_.begin();
    record_copy(copy);
    transfer_.end();
    context_.submit_transfer(copy, uploaded_.get());
  }
  try {
    context_.submit(commands, is_separate ? uploaded_.get() : VK_NULL_HANDLE, done_.get());
  } catch (...) {
    // A semaphore that was signalled and waited for by nobody cannot be used again.
    context_.drain();
    if (is_separate) {
      uploaded_ = {};
      uploaded_ = context_.semaphore();
    }
    throw;
  }
  is_uploaded_ = true;
}

void Flight::finish() { context_.wait(done_.get(), windows_); }

}  // namespace fathom::vulkan
