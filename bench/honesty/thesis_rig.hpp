// SPDX-License-Identifier: Apache-2.0
// The thesis' rig as `sim` plays it, and random numbers for it.
#pragma once

#include <optional>
#include <random>
#include <string>

#include "engine/window.hpp"

namespace fathom::honesty {

/// Uniform in [low, high), the same on every machine.
double pick(std::mt19937& random, double low, double high);

/// Where the lens has a target at this distance in focus, in steps (docs/optics.md).
double steps_of(double distance_mm);

/// Half the depth of field round that, in steps.
double half_depth_in_steps(double distance_mm);

/// Where the pictures of such a rig are sharpest by the metric, without noise: an object that has a
/// depth is not in focus where the tape measures to.
double sharpest(const std::string& text, const std::string& metric,
                const std::optional<Window>& window, double distance_mm);

}  // namespace fathom::honesty
