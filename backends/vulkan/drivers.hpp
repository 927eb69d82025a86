// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace fathom::vulkan {

/// What the list of Vulkan devices depends on (backends/gpu/drivers.hpp). Empty where there is no
/// loader: then there is nothing to keep.
std::string drivers();

}  // namespace fathom::vulkan
