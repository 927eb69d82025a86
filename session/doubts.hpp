// SPDX-License-Identifier: Apache-2.0
// What the pictures of a run tell that its scores do not.
#pragma once

#include <span>

#include "../engine/travel.hpp"
#include "../focus/focus.hpp"
#include "measurement.hpp"
#include "observer.hpp"

namespace fathom {

/// Tells of light, noise and saturation in a sweep's pictures, as far as they are worth a warning.
/// best: position of the best one.
void tell_doubts(std::span<const Measurement> measurements, double best, Observer& observer);

/// The same of a search, and whether all of the window is at one distance.
void tell_doubts(std::span<const Measurement> measurements, const Focus& focus,
                 const LensInfo& lens, Observer& observer);

}  // namespace fathom
