// SPDX-License-Identifier: Apache-2.0
#include "backends/opencl/plan.hpp"

#include "backends/gpu/plan.hpp"
#include "backends/opencl/flight.hpp"

namespace fathom::opencl {

std::unique_ptr<Plan> make_plan(std::shared_ptr<Context> context, const MetricSpec& spec,
                                std::size_t capacity) {
  using FlightPlan = gpu::FlightPlan<Context, Program, Flight>;
  return std::make_unique<FlightPlan>(std::move(context), spec, capacity);
}

}  // namespace fathom::opencl
