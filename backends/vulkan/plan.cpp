// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/plan.hpp"

#include "backends/gpu/plan.hpp"
#include "backends/vulkan/flight.hpp"

namespace fathom::vulkan {

std::unique_ptr<Plan> make_plan(std::shared_ptr<Context> context, const MetricSpec& spec,
                                std::size_t capacity) {
  using FlightPlan = gpu::FlightPlan<Context, Program, Flight>;
  return std::make_unique<FlightPlan>(std::move(context), spec, capacity);
}

}  // namespace fathom::vulkan
