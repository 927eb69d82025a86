// SPDX-License-Identifier: Apache-2.0
// What a metric must be to have a focus.
#pragma once

#include "engine/metric.hpp"

namespace fathom {

/// A focus curve has one number at each position. Throws Error(bad_argument) for a metric that gives
/// several.
void require_one_number(const MetricSpec& spec);

}  // namespace fathom
