// SPDX-License-Identifier: Apache-2.0
// Vulkan's functions, found at run time by volk, so that Fathom starts where there is no Vulkan;
// and what their results mean.
#pragma once

#include <volk.h>

namespace fathom::vulkan {

/// The functions of one device, without the loader's detour.
using DeviceApi = VolkDeviceTable;

/// Finds the Vulkan loader of this machine, once. Throws Error(unavailable) where there is none.
void require_loader();

/// Makes the functions that take an instance or a physical device known to volk, once: they are the
/// loader's own, the same for every instance.
void load_instance_functions(VkInstance instance);

/// Throws an Error that says what was being done, unless the result is VK_SUCCESS.
void check(VkResult result, const char* doing);

}  // namespace fathom::vulkan
