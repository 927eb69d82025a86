// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "backends/vulkan/context.hpp"
#include "engine/backend.hpp"

namespace fathom::vulkan {

/// A plan on an opened device (backends/gpu/plan.hpp). Throws Error(out_of_memory).
std::unique_ptr<Plan> make_plan(std::shared_ptr<Context> context, const MetricSpec& spec,
                                std::size_t capacity);

}  // namespace fathom::vulkan
