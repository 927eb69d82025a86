// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "backends/opencl/context.hpp"
#include "engine/backend.hpp"

namespace fathom::opencl {

/// A plan on an opened device (backends/gpu/plan.hpp). Throws Error(out_of_memory, unavailable).
std::unique_ptr<Plan> make_plan(std::shared_ptr<Context> context, const MetricSpec& spec,
                                std::size_t capacity);

}  // namespace fathom::opencl
