// SPDX-License-Identifier: Apache-2.0
// The kernels as SPIR-V, embedded when this was built.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "backends/gpu/shape.hpp"

namespace fathom::vulkan {

/// A module with the entry point main.
std::span<const std::uint32_t> spirv(gpu::Kernel kernel);

/// A hash of all of them: what is kept on disk of one build's kernels is not for another's.
const std::string& kernels_key();

}  // namespace fathom::vulkan
