// SPDX-License-Identifier: Apache-2.0
// Following a target that moves: the next focus is looked for where the last one was.
#pragma once

#include "focus.hpp"

namespace fathom {

/// The focus again, from where it was: both slopes and the top of the last peak first, a few places
/// more where it has moved, and a whole search where it is not found there. What the last search
/// saw far from its peak stands for the floor. before: must be focused, with a fitted peak; else,
/// and for the first time, this is search_focus().
Focus track_focus(const Objective& objective, const FocusLimits& limits, const MetricSpec& spec,
                  double repeat_scatter, const Focus& before);

}  // namespace fathom
