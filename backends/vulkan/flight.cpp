// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/flight.hpp"

#include <algorithm>

#include "backends/gpu/spectrum.hpp"

namespace fathom::vulkan {
namespace {

Handle<VkCommandPool> command_pool(const Context& context, std::uint32_t queue_family) {
  VkCommandPoolCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  info.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  info.queueFamilyIndex = queue_family;
  VkCommandPool pool = VK_NULL_HANDLE;
  check(context.api().vkCreateCommandPool(context.device(), &info, nullptr, &pool),
        "a command pool");
  return {context.device(), pool, context.api().vkDestroyCommandPool};
}

VkCommandBuffer command_buffer(const Context& context, VkCommandPool pool) {
  VkCommandBufferAllocateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  info.commandPool = pool;
  info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  info.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  check(context.api().vkAllocateCommandBuffers(context.device(), &info, &commands),
        "a command buffer");
  return commands;
}

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

void barrier(const DeviceApi& api, VkCommandBuffer commands, VkPipelineStageFlags from,
             VkAccessFlags written, VkPipelineStageFlags to, VkAccessFlags wanted) {
  VkMemoryBarrier memory = {};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  memory.srcAccessMask = written;
  memory.dstAccessMask = wanted;
  api.vkCmdPipelineBarrier(commands, from, to, 0, 1, &memory, 0, nullptr, 0, nullptr);
}

}  // namespace

Commands::Commands(const Context& context, std::uint32_t queue_family)
    : context_(context),
      pool_(command_pool(context, queue_family)),
      buffer_(command_buffer(context, pool_.get())) {}

VkCommandBuffer Commands::begin() const {
  VkCommandBufferBeginInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(context_.api().vkBeginCommandBuffer(buffer_, &info), "recording commands");
  return buffer_;
}

void Commands::end() const {
  check(context_.api().vkEndCommandBuffer(buffer_), "recording commands");
}

Flight::Flight(Context& context, std::size_t windows)
    : context_(context),
      done_(context.fence()),
      uploaded_(context.has_transfer_queue() ? context.semaphore() : Handle<VkSemaphore>()),
      compute_(context, context.physical().compute_family),
      transfer_(context,
                context.physical().transfer_family.value_or(context.physical().compute_family)),
      descriptor_pool_(descriptor_pool(context, 2)),
      origins_(context.buffer(4 * windows, Place::host_written, "a list of windows")),
      scores_(context.buffer(8 * windows, Place::device_written, "scores")),
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
  const std::size_t bytes = part.bytes(frame.depth());
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
  part.copy(frame, static_cast<std::byte*>(is_unified ? frame_.mapped : staging_.mapped));
  auto* const origins = static_cast<std::uint32_t*>(origins_.mapped);
  windows_ = ids.empty() ? windows.size() : ids.size();
  for (std::size_t i = 0; i < windows_; ++i) {
    origins[i] = part.origin(windows[ids.empty() ? i : ids[i]], depth_);
  }
}

void Flight::show(VkDescriptorSet set, const Program& program) const {
  VkBuffer buffers[FATHOM_BINDINGS] = {};
  buffers[FATHOM_FRAME] = frame_.buffer.get();
  buffers[FATHOM_WINDOWS] = origins_.buffer.get();
  buffers[FATHOM_SCORES] = scores_.buffer.get();
  buffers[FATHOM_TABLES] = program.tables();
  // What a kernel does not touch must be some buffer all the same.
  const VkBuffer none = scores_.buffer.get();
  buffers[FATHOM_SCRATCH] = program.scratch() != VK_NULL_HANDLE ? program.scratch() : none;
  buffers[FATHOM_DOUBTFUL] = doubtful_.buffer.get();
  buffers[FATHOM_SPECTRUM] = spectrum_.bytes > 0 ? spectrum_.buffer.get() : none;
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
  if (program.scratch() != VK_NULL_HANDLE) wait_for_shaders(api, commands);
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
  show(sets_[0], program);
  if (rescue != nullptr) show(sets_[1], *rescue);
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

void Flight::finish() { context_.wait(done_.get()); }

}  // namespace fathom::vulkan
