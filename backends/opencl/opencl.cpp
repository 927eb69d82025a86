// SPDX-License-Identifier: Apache-2.0
// The `opencl` backend behind the contract: what has an OpenCL 1.2 driver, and processors on
// request.
#include <fmt/format.h>

#include "backends/backends.hpp"
#include "backends/gpu/device.hpp"
#include "backends/opencl/drivers.hpp"
#include "backends/opencl/plan.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

class OpenclBackend final : public Backend {
 public:
  const char* name() const noexcept override { return "opencl"; }
  bool is_for_gpus() const noexcept override { return true; }
  std::string drivers() const override { return opencl::drivers(); }

  std::vector<DeviceInfo> devices() const override {
    std::vector<DeviceInfo> infos;
    try {
      for (const auto& device : opencl::list_devices()) infos.push_back(device.info);
    } catch (const Error&) {
      // open() says why.
    }
    return infos;
  }

  std::unique_ptr<Device> open(std::size_t index, const DeviceOptions&) const override {
    const auto devices = opencl::list_devices();
    if (devices.empty()) {
      throw Error(ErrorCode::unavailable, "its OpenCL drivers find no device on this machine");
    }
    if (index >= devices.size()) {
      throw Error(ErrorCode::unavailable,
                  fmt::format("there are opencl:0 to opencl:{}", devices.size() - 1));
    }
    const opencl::PhysicalDevice& physical = devices[index];
    return std::make_unique<gpu::FlightDevice<opencl::Context>>(
        physical.info, gpu::Opening<opencl::Context>{
                           [physical] { return std::make_shared<opencl::Context>(physical); },
                           physical.limits, "opencl-" + physical.identity, opencl::kernels_key()});
  }
};

}  // namespace

const Backend& opencl_backend() {
  // Never destroyed: when static objects go, drivers may have gone before them.
  static const auto* const backend = new OpenclBackend;
  return *backend;
}

}  // namespace fathom
