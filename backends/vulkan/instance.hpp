// SPDX-License-Identifier: Apache-2.0
// A connection to Vulkan and the devices that it lists.
#pragma once

#include <vector>

#include "backends/vulkan/physical.hpp"

namespace fathom::vulkan {

class Instance {
 public:
  /// Throws Error(unavailable) saying what is missing: the loader or a driver.
  Instance();
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  const std::vector<PhysicalDevice>& devices() const { return devices_; }

 private:
  VkInstance instance_ = VK_NULL_HANDLE;
  std::vector<PhysicalDevice> devices_;
};

}  // namespace fathom::vulkan
