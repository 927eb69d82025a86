// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/context.hpp"

#include <algorithm>

#include "engine/error.hpp"

namespace fathom::vulkan {
namespace {

VkDevice create_device(const PhysicalDevice& physical) {
  const float priority = 1;
  VkDeviceQueueCreateInfo queues[2] = {};
  for (VkDeviceQueueCreateInfo& queue : queues) {
    queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
  }
  queues[0].queueFamilyIndex = physical.compute_family;
  queues[1].queueFamilyIndex = physical.transfer_family.value_or(0);
  VkDeviceCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.queueCreateInfoCount = physical.transfer_family ? 2 : 1;
  info.pQueueCreateInfos = queues;
  const char* const portability = "VK_KHR_portability_subset";
  if (physical.has_portability_subset) {
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = &portability;
  }
  VkDevice device = VK_NULL_HANDLE;
  check(vkCreateDevice(physical.handle, &info, nullptr, &device), "opening the device");
  return device;
}

VkSubmitInfo submit_info(const VkCommandBuffer& commands) {
  VkSubmitInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands;
  return info;
}

}  // namespace

Context::Context(std::shared_ptr<const Instance> instance, const PhysicalDevice& physical)
    : instance_(std::move(instance)), physical_(physical), wait_limit_(physical.info.kind) {
  if (!physical.refusal.empty()) throw Error(ErrorCode::unavailable, physical.refusal);
  device_ = create_device(physical);
  volkLoadDeviceTable(&api_, device_);
  try {
    api_.vkGetDeviceQueue(device_, physical.compute_family, 0, &queue_);
    if (physical.transfer_family) {
      api_.vkGetDeviceQueue(device_, *physical.transfer_family, 0, &transfer_queue_);
    }
    pipelines_ = std::make_unique<Pipelines>(api_, device_, physical.identity);
  } catch (...) {
    api_.vkDestroyDevice(device_, nullptr);
    throw;
  }
}

Context::~Context() {
  if (is_given_up_) {  // to destroy the device would be to wait for it
    gpu::keep_for_ever(std::move(pipelines_));
    gpu::keep_for_ever(std::const_pointer_cast<Instance>(instance_));
    return;
  }
  drain();
  pipelines_.reset();
  api_.vkDestroyDevice(device_, nullptr);
}

VkPipeline Context::pipeline(gpu::Kernel kernel, const gpu::Constants& constants) {
  try {
    return pipelines_->get(kernel, constants);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::device_lost) is_lost_ = true;
    throw;
  }
}

Handle<VkFence> Context::fence() const {
  VkFenceCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  VkFence fence = VK_NULL_HANDLE;
  check(api_.vkCreateFence(device_, &info, nullptr, &fence), "a fence");
  return {device_, fence, api_.vkDestroyFence};
}

Handle<VkSemaphore> Context::semaphore() const {
  VkSemaphoreCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO;
  VkSemaphore semaphore = VK_NULL_HANDLE;
  check(api_.vkCreateSemaphore(device_, &info, nullptr, &semaphore), "a semaphore");
  return {device_, semaphore, api_.vkDestroySemaphore};
}

void Context::submit_transfer(VkCommandBuffer commands, VkSemaphore done) {
  VkSubmitInfo info = submit_info(commands);
  info.signalSemaphoreCount = 1;
  info.pSignalSemaphores = &done;
  const std::lock_guard lock(queue_mutex_);
  check_alive(api_.vkQueueSubmit(transfer_queue_, 1, &info, VK_NULL_HANDLE), "submitting a copy");
}

void Context::submit(VkCommandBuffer commands, VkSemaphore after, VkFence done) {
  constexpr VkPipelineStageFlags kStage = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;
  VkSubmitInfo info = submit_info(commands);
  if (after != VK_NULL_HANDLE) {
    info.waitSemaphoreCount = 1;
    info.pWaitSemaphores = &after;
    info.pWaitDstStageMask = &kStage;
  }
  const std::lock_guard lock(queue_mutex_);
  check_alive(api_.vkQueueSubmit(queue_, 1, &info, done), "submitting work");
}

void Context::wait(VkFence fence, std::size_t windows) {
  if (is_given_up_) require_alive();  // nobody waits for it twice
  const double limit_s = wait_limit_.seconds(windows);
  const auto limit_ns = static_cast<std::uint64_t>(std::min(1e9 * limit_s, 1e18));
  const VkResult result = api_.vkWaitForFences(device_, 1, &fence, VK_TRUE, limit_ns);
  if (result == VK_TIMEOUT) {
    is_lost_ = is_given_up_ = true;
    throw gpu::given_up(physical_.info.name, limit_s);
  }
  check_alive(result, "waiting for the device");
  check_alive(api_.vkResetFences(device_, 1, &fence), "resetting a fence");
}

void Context::drain() noexcept {
  if (is_given_up_) return;
  const std::lock_guard lock(queue_mutex_);
  api_.vkDeviceWaitIdle(device_);
}

void Context::require_alive() const {
  if (is_lost_)
    throw Error(ErrorCode::device_lost, physical_.info.name + " was lost; make a new plan");
}

void Context::check_alive(VkResult result, const char* doing) {
  if (result == VK_ERROR_DEVICE_LOST) is_lost_ = true;
  check(result, doing);
}

}  // namespace fathom::vulkan
