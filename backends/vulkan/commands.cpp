// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/commands.hpp"

#include <algorithm>

namespace fathom::vulkan {
namespace {

/// Of one update of a buffer.
constexpr std::size_t kMostWords = 65536 / sizeof(std::uint32_t);

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

void barrier(const DeviceApi& api, VkCommandBuffer commands, VkPipelineStageFlags from,
             VkAccessFlags written, VkPipelineStageFlags to, VkAccessFlags wanted) {
  VkMemoryBarrier memory = {};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  memory.srcAccessMask = written;
  memory.dstAccessMask = wanted;
  api.vkCmdPipelineBarrier(commands, from, to, 0, 1, &memory, 0, nullptr, 0, nullptr);
}

void write_start(Context& context, Buffer& buffer, std::span<const std::uint32_t> words) {
  Commands commands(context, context.physical().compute_family);
  Handle<VkFence> done = context.fence();
  const DeviceApi& api = context.api();
  const VkCommandBuffer recorded = commands.begin();
  for (std::size_t first = 0; first < words.size(); first += kMostWords) {
    const auto some = words.subspan(first, std::min(kMostWords, words.size() - first));
    api.vkCmdUpdateBuffer(recorded, buffer.buffer.get(), sizeof words[0] * first, some.size_bytes(),
                          some.data());
  }
  barrier(api, recorded, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
          VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT);
  commands.end();
  context.submit(recorded, VK_NULL_HANDLE, done.get());
  try {
    context.wait(done.get(), 0);
  } catch (...) {
    context.drain();  // before what the device may still use goes
    if (context.is_given_up()) {
      gpu::keep_for_ever(std::make_shared<Commands>(std::move(commands)));
      gpu::keep_for_ever(std::make_shared<Handle<VkFence>>(std::move(done)));
      gpu::keep_for_ever(std::make_shared<Buffer>(std::move(buffer)));
    }
    throw;
  }
}

}  // namespace fathom::vulkan
