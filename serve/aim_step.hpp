// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "serve/procedures.hpp"

namespace fathom::serve {

/// Looks round, and chooses the window that the order wishes for; outcome.window is absent where there
/// is none, and the words say why. Throws as Session::visit and DepthMaker.
void find_window(const Work& work, Rig& rig, Observer& all, Outcome& outcome);

}  // namespace fathom::serve
