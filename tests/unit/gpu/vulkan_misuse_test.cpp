// SPDX-License-Identifier: Apache-2.0
// A wrong call on purpose: proves to tests/unit/gpu/validated that the validation layer listens.
#include <gtest/gtest.h>

#include "backends/vulkan/context.hpp"

namespace fathom::vulkan {
namespace {

// Disabled, because it is wrong; the script asks for it by name.
TEST(VulkanMisuse, DISABLED_ABufferOfNoBytes) {
  const auto instance = std::make_shared<const Instance>();
  ASSERT_FALSE(instance->devices().empty());
  const Context context(instance, instance->devices()[0]);
  VkBufferCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  if (context.api().vkCreateBuffer(context.device(), &info, nullptr, &buffer) == VK_SUCCESS) {
    context.api().vkDestroyBuffer(context.device(), buffer, nullptr);
  }
}

}  // namespace
}  // namespace fathom::vulkan
