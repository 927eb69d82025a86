// SPDX-License-Identifier: Apache-2.0
// Depth from defocus: a focus from no more pictures than somebody allows, wherever they are blurred
// (Pentland 1987, Subbarao 1988).
#pragma once

#include "focus.hpp"

namespace fathom {

/// Evaluates at most limits.most_pictures positions from limits.start on, and says what the law of
/// defocus makes of them. No peak of scores is asked for, none is passed, and nothing is looked at
/// again: sigma says how far that can be believed. limits.blur must be there.
Focus budget_search(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter);

}  // namespace fathom
