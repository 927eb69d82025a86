// SPDX-License-Identifier: Apache-2.0
// The `vulkan` backend behind the contract: every GPU with a Vulkan 1.1 driver, and software
// rasterisers on request.
#include <fmt/format.h>

#include <mutex>
#include <optional>

#include "backends/backends.hpp"
#include "backends/vulkan/arithmetic.hpp"
#include "backends/vulkan/plan.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

class VulkanDevice final : public Device {
 public:
  VulkanDevice(std::shared_ptr<const vulkan::Instance> instance,
               const vulkan::PhysicalDevice& physical)
      : Device(physical.info),
        instance_(std::move(instance)),
        physical_(physical),
        context_(std::make_shared<vulkan::Context>(instance_, physical_)) {}

  std::string unsupported(const MetricSpec& spec) const override {
    const std::string reason = gpu::too_small_for(spec, physical_.limits);
    // Sums of small integers are exact in any arithmetic.
    return !reason.empty() || spec.is_exact() ? reason : arithmetic_fault();
  }

 private:
  /// A lost device stays lost for its plans; the next plan gets a fresh one.
  std::shared_ptr<vulkan::Context> live_context() const {
    const std::lock_guard lock(context_mutex_);
    if (context_->is_lost()) {
      context_ = std::make_shared<vulkan::Context>(instance_, physical_);
    }
    return context_;
  }

  /// Why this device's floats are not to be trusted, measured once.
  const std::string& arithmetic_fault() const {
    const std::lock_guard lock(fault_mutex_);
    if (!arithmetic_fault_) {
      arithmetic_fault_ = vulkan::arithmetic_fault(
          physical_.identity,
          [this](const MetricSpec& spec) { return vulkan::make_plan(live_context(), spec, 1); });
    }
    return *arithmetic_fault_;
  }

  std::unique_ptr<Plan> do_plan(const MetricSpec& spec, std::size_t capacity) override {
    return vulkan::make_plan(live_context(), spec, capacity);
  }

  std::shared_ptr<const vulkan::Instance> instance_;
  vulkan::PhysicalDevice physical_;
  mutable std::mutex context_mutex_;
  mutable std::shared_ptr<vulkan::Context> context_;
  mutable std::mutex fault_mutex_;
  mutable std::optional<std::string> arithmetic_fault_;
};

class VulkanBackend final : public Backend {
 public:
  const char* name() const noexcept override { return "vulkan"; }
  bool is_for_gpus() const noexcept override { return true; }

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
    return std::make_unique<VulkanDevice>(instance, devices[index]);
  }

 private:
  /// Connecting takes a driver tens of milliseconds, and whoever opens a device has just listed
  /// them: that connection serves once more.
  std::shared_ptr<const vulkan::Instance> connect() const {
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
