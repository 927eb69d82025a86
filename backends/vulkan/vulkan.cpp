// SPDX-License-Identifier: Apache-2.0
// The `vulkan` backend behind the contract: every GPU with a Vulkan 1.1 driver, and software
// rasterisers on request.
#include <fmt/format.h>

#include <mutex>

#include "backends/backends.hpp"
#include "backends/gpu/device.hpp"
#include "backends/gpu/drivers_process.hpp"
#include "backends/vulkan/drivers.hpp"
#include "backends/vulkan/plan.hpp"
#include "backends/vulkan/spirv.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

using VulkanDevice = gpu::FlightDevice<vulkan::Context>;

std::unique_ptr<Device> open_device(const std::shared_ptr<const vulkan::Instance>& instance,
                                    const vulkan::PhysicalDevice& physical) {
  return std::make_unique<VulkanDevice>(
      physical.info, gpu::Opening<vulkan::Context>{
                         [=] { return std::make_shared<vulkan::Context>(instance, physical); },
                         physical.limits, "vulkan-" + physical.identity, vulkan::kernels_key()});
}

class VulkanBackend final : public Backend {
 public:
  const char* name() const noexcept override { return "vulkan"; }
  bool is_for_gpus() const noexcept override { return true; }
  std::string drivers() const override { return vulkan::drivers(); }

  std::vector<DeviceInfo> devices() const override {
    std::vector<DeviceInfo> infos;
    try {
      const auto instance = std::make_shared<const vulkan::Instance>();
      for (const auto& device : instance->devices()) infos.push_back(device.info);
      const std::lock_guard lock(mutex_);
      listed_ = instance;
    } catch (const Error&) {
      // open() says why.
    }
    return infos;
  }

  std::unique_ptr<Device> open(std::size_t index, const DeviceOptions&) const override {
    const auto instance = connect();
    const auto& devices = instance->devices();
    if (devices.empty()) {
      throw Error(ErrorCode::unavailable, "its Vulkan drivers find no device on this machine");
    }
    if (index >= devices.size()) {
      throw Error(ErrorCode::unavailable,
                  fmt::format("there are vulkan:0 to vulkan:{}", devices.size() - 1));
    }
    return open_device(instance, devices[index]);
  }

 private:
  /// Connecting takes a driver tens of milliseconds, and whoever opens a device has just listed
  /// them: that connection serves once more.
  std::shared_ptr<const vulkan::Instance> connect() const {
    gpu::require_process_for_drivers();
    {
      const std::lock_guard lock(mutex_);
      if (listed_ != nullptr) return std::exchange(listed_, nullptr);
    }
    return std::make_shared<const vulkan::Instance>();
  }

  mutable std::mutex mutex_;
  mutable std::shared_ptr<const vulkan::Instance> listed_;
};

}  // namespace

const Backend& vulkan_backend() {
  // Never destroyed: when static objects go, drivers may have gone before them.
  static const auto* const backend = new VulkanBackend;
  return *backend;
}

}  // namespace fathom
