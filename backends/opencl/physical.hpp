// SPDX-License-Identifier: Apache-2.0
// What is known of a device before it is opened.
#pragma once

#include <string>
#include <vector>

#include "backends/gpu/shape.hpp"
#include "backends/opencl/api.hpp"
#include "engine/backend.hpp"

namespace fathom::opencl {

struct PhysicalDevice {
  cl_platform_id platform = nullptr;
  cl_device_id id = nullptr;
  DeviceInfo info;
  gpu::Limits limits;
  bool is_unified = false;  ///< Device and host share their memory: no copy in between.
  std::string refusal;      ///< Why it cannot be opened; empty if it can.
  std::string identity;     ///< Device and driver: what a cache of its programs is for.
};

/// Of all platforms, in the loader's order. Throws Error(unavailable) where there is no loader or
/// no driver.
std::vector<PhysicalDevice> list_devices();

}  // namespace fathom::opencl
