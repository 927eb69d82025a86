// SPDX-License-Identifier: Apache-2.0
// How the lens of a stack blurs, from the stack itself: the law under which all windows are
// likeliest at once.
#pragma once

#include <span>

#include "depth/profile.hpp"
#include "depth/scoring.hpp"

namespace fathom::depth {

/// frames: numbers of those that were scored; positions: theirs, in the same order, two different ones
/// at least. Looks at a sample of the windows with texture; where there is none, it answers something
/// usual.
StackBlur fit_blur_of_stack(const Scoring& scoring, std::span<const std::size_t> frames,
                            std::span<const double> positions, int threads);

/// Foci that are worth a look between the first frame and the last, for a lens that blurs so.
FocusGrid focus_grid(const StackBlur& blur, std::span<const double> positions);

}  // namespace fathom::depth
