// SPDX-License-Identifier: Apache-2.0
// An opened device: its queues, its memory and the kernels that plans share.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>

#include "backends/gpu/wait_limit.hpp"
#include "backends/vulkan/instance.hpp"
#include "backends/vulkan/memory.hpp"
#include "backends/vulkan/pipelines.hpp"

namespace fathom::vulkan {

/// Safe to use from several threads, but for what a plan owns.
class Context {
 public:
  /// Throws Error(unavailable).
  Context(std::shared_ptr<const Instance> instance, const PhysicalDevice& physical);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const DeviceApi& api() const { return api_; }
  VkDevice device() const { return device_; }
  const PhysicalDevice& physical() const { return physical_; }
  const gpu::Limits& limits() const { return physical_.limits; }

  VkDescriptorSetLayout set_layout() const { return pipelines_->set_layout(); }
  VkPipelineLayout pipeline_layout() const { return pipelines_->layout(); }

  /// A kernel compiled with these constants; the same for every plan that asks.
  VkPipeline pipeline(gpu::Kernel kernel, const gpu::Constants& constants);

  /// Throws Error(out_of_memory) saying how much was wanted and for what.
  Buffer buffer(VkDeviceSize bytes, Place place, const char* what) const {
    return make_buffer(api_, device_, physical_, bytes, place, what);
  }

  /// Whether copies to the device have a queue of their own.
  bool has_transfer_queue() const { return transfer_queue_ != VK_NULL_HANDLE; }

  Handle<VkFence> fence() const;
  Handle<VkSemaphore> semaphore() const;

  /// Starts copying; the semaphore tells the queue that computes. Throws Error(device_lost).
  void submit_transfer(VkCommandBuffer commands, VkSemaphore done);

  /// Starts computing, after the semaphore if there is one; the fence tells the host. Throws
  /// Error(device_lost).
  void submit(VkCommandBuffer commands, VkSemaphore after, VkFence done);

  /// Waits and resets; windows: of the batch. Throws Error(device_lost), Error(timeout) where the
  /// device takes longer than it may (gpu::WaitLimit): then it is lost and given up.
  void wait(VkFence fence, std::size_t windows);

  /// Waits for everything, whatever comes of it, unless the device was given up: for destructors
  /// and unwinding.
  void drain() noexcept;

  /// Whether the device was lost: then every call fails, and only a new Context helps.
  bool is_lost() const { return is_lost_; }
  /// Whether it may still be at work: then what it was given must never go (gpu::keep_for_ever).
  bool is_given_up() const { return is_given_up_; }
  /// Throws Error(device_lost) if it was.
  void require_alive() const;

 private:
  void check_alive(VkResult result, const char* doing);

  std::shared_ptr<const Instance> instance_;
  PhysicalDevice physical_;
  DeviceApi api_ = {};
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  VkQueue transfer_queue_ = VK_NULL_HANDLE;
  std::mutex queue_mutex_;
  gpu::WaitLimit wait_limit_;
  std::atomic<bool> is_lost_ = false, is_given_up_ = false;
  std::unique_ptr<Pipelines> pipelines_;
};

}  // namespace fathom::vulkan
