// SPDX-License-Identifier: Apache-2.0
// The search of a recording by spectra while nobody knows how its lens blurred: blur and focus are
// fitted together.
#pragma once

#include "focus.hpp"

namespace fathom {

/// Evaluates limits.coarse, thinned where that is long. Where the pictures tell no blur, `auto`
/// without spectra follows. limits.blur must be absent.
Focus joint_search(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter);

}  // namespace fathom
