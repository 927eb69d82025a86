// SPDX-License-Identifier: Apache-2.0
// Metrics that a device has no kernel for, computed from its spectra.
#pragma once

#include <cstddef>
#include <memory>

#include "backend.hpp"

namespace fathom {

/// A plan for `spec` that measures the spectra of `plain`, a plan for spec.plain(), one window
/// after another: so that a new measure works on every device from its first day on.
std::unique_ptr<Plan> plan_from_spectra(std::unique_ptr<Plan> plain, const MetricSpec& spec,
                                        std::size_t capacity);

}  // namespace fathom
