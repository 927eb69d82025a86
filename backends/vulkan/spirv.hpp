// SPDX-License-Identifier: Apache-2.0
// The kernels as SPIR-V, embedded when this was built.
#pragma once

#include <cstdint>
#include <span>

#include "backends/gpu/shape.hpp"

namespace fathom::vulkan {

/// A module with the entry point main.
std::span<const std::uint32_t> spirv(gpu::Kernel kernel);

}  // namespace fathom::vulkan
