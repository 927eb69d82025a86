// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "backends/vulkan/context.hpp"
#include "engine/backend.hpp"

namespace fathom::vulkan {

/// A plan on an opened device, which it keeps open. Submitting allocates on the device only for a
/// frame larger than all before, and compiles only for the first of 16 bits. Throws
/// Error(out_of_memory).
std::unique_ptr<Plan> make_plan(std::shared_ptr<Context> context, const MetricSpec& spec,
                                std::size_t capacity);

}  // namespace fathom::vulkan
