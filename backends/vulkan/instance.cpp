// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/instance.hpp"

#include "backends/gpu/drivers_process.hpp"

namespace fathom::vulkan {
namespace {

VkInstance create() {
  gpu::require_process_for_drivers();
  require_loader();
  VkApplicationInfo application = {};
  application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  application.pApplicationName = application.pEngineName = "fathom";
  application.apiVersion = VK_API_VERSION_1_1;
  VkInstanceCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pApplicationInfo = &application;
  // Without this, drivers that are conformant but for a subset (MoltenVK) are not listed.
  const char* const portability = VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME;
  const auto extensions = list<VkExtensionProperties>(
      [&](auto* count, auto* items) {
        return vkEnumerateInstanceExtensionProperties(nullptr, count, items);
      },
      "listing extensions");
  if (has_extension(extensions, portability)) {
    info.flags |= VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR;
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = &portability;
  }
  VkInstance instance = VK_NULL_HANDLE;
  check(vkCreateInstance(&info, nullptr, &instance), "starting Vulkan");
  return instance;
}

}  // namespace

Instance::Instance() : instance_(create()) {
  load_instance_functions(instance_);
  try {
    for (VkPhysicalDevice handle : list<VkPhysicalDevice>(
             [&](auto*count, auto*items) {
               return vkEnumeratePhysicalDevices(instance_, count, items);
             },
             "listing devices")) {
      devices_.push_back(describe(handle));
    }
  } catch (...) {
    vkDestroyInstance(instance_, nullptr);
    throw;
  }
}

Instance::~Instance() { vkDestroyInstance(instance_, nullptr); }

}  // namespace fathom::vulkan
