// SPDX-License-Identifier: Apache-2.0
// Whether a device computes as IEEE 754 has it. Two-float arithmetic (kernels/double_float.glsl,
// .clh) lives on correctly rounded sums and on compilers that leave it alone; Vulkan promises the
// first but for the direction of rounding, and some translated drivers break the second.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "engine/backend.hpp"

namespace fathom::gpu {

/// Scores a few windows of N = 16 by both kernels and compares with the oracle. Empty if they agree
/// to the project's tolerance, else one line on where they do not. That they do is kept in the file
/// cache: file and key must name backend, device, driver and kernels, so that plans are made only
/// where nobody knows yet. Throws what making a plan and scoring throw.
std::string arithmetic_fault(std::string_view file, std::string_view key,
                             const std::function<std::unique_ptr<Plan>(const MetricSpec&)>& plan);

}  // namespace fathom::gpu
