// SPDX-License-Identifier: Apache-2.0
#include "bench/vulkan/vkfft.hpp"

#include <fmt/format.h>
#include <glslang/Include/glslang_c_interface.h>
#include <glslang/Public/resource_limits_c.h>

#include <initializer_list>
#include <stdexcept>

// VkFFT 1.2 lists the limits of an older glslang one by one, with fewer numbers than this one has.
// This takes any such list, and gives the same limits by glslang's own hand.
struct VkfftLimits {
  struct Limit {
    Limit(int) {}
    Limit(std::initializer_list<int>) {}
  };
  VkfftLimits(std::initializer_list<Limit>) {}
  const glslang_resource_t* operator&() const { return glslang_default_resource(); }
};
#define glslang_resource_t VkfftLimits
#define VKFFT_BACKEND 0  // Vulkan
// After ours, whose volk.h stands in for Vulkan's own functions.
#include <vkFFT.h>
#undef glslang_resource_t

namespace fathom::bench {
namespace {

void require(int result, const char* what) {
  if (result != 0) throw std::runtime_error(fmt::format("{} failed ({})", what, result));
}

vulkan::Handle<VkCommandPool> command_pool(const vulkan::Context& context) {
  VkCommandPoolCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  info.queueFamilyIndex = context.physical().compute_family;
  VkCommandPool pool = VK_NULL_HANDLE;
  require(context.api().vkCreateCommandPool(context.device(), &info, nullptr, &pool),
          "a command pool");
  return {context.device(), pool, context.api().vkDestroyCommandPool};
}

VkQueue queue_of(const vulkan::Context& context) {
  VkQueue queue = VK_NULL_HANDLE;
  context.api().vkGetDeviceQueue(context.device(), context.physical().compute_family, 0, &queue);
  return queue;
}

class Vkfft final : public VulkanFft {
 public:
  Vkfft(const vulkan::Context& context, int n, std::size_t batch, const vulkan::Buffer& data)
      : pool_(command_pool(context)),
        fence_(context.fence()),
        physical_device_(context.physical().handle),
        device_(context.device()),
        queue_(queue_of(context)),
        pool_handle_(pool_.get()),
        fence_handle_(fence_.get()),
        buffer_(data.buffer.get()),
        bytes_(data.bytes) {
    // VkFFT calls Vulkan's functions by their global names, which our own code leaves empty.
    volkLoadDevice(device_);
    VkFFTConfiguration wish = {};
    wish.FFTdim = 2;
    wish.size[0] = wish.size[1] = static_cast<std::uint64_t>(n);
    wish.numberBatches = batch;
    wish.performR2C = 1;
    wish.physicalDevice = &physical_device_;
    wish.device = &device_;
    wish.queue = &queue_;
    wish.commandPool = &pool_handle_;
    wish.fence = &fence_handle_;
    wish.buffer = &buffer_;
    wish.bufferSize = &bytes_;
    require(initializeVkFFT(&application_, wish), "VkFFT's plan");
  }
  ~Vkfft() override { deleteVkFFT(&application_); }

  void record(VkCommandBuffer commands) override {
    VkFFTLaunchParams launch = {};
    launch.commandBuffer = &commands;
    launch.buffer = &buffer_;
    require(VkFFTAppend(&application_, -1, &launch), "VkFFT");
  }

 private:
  vulkan::Handle<VkCommandPool> pool_;
  vulkan::Handle<VkFence> fence_;
  // VkFFT keeps their addresses.
  VkPhysicalDevice physical_device_;
  VkDevice device_;
  VkQueue queue_;
  VkCommandPool pool_handle_;
  VkFence fence_handle_;
  VkBuffer buffer_;
  std::uint64_t bytes_;
  VkFFTApplication application_ = {};
};

}  // namespace

std::unique_ptr<VulkanFft> make_vulkan_fft(const vulkan::Context& context, int n, std::size_t batch,
                                           const vulkan::Buffer& data) {
  return std::make_unique<Vkfft>(context, n, batch, data);
}

}  // namespace fathom::bench
