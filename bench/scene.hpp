// SPDX-License-Identifier: Apache-2.0
// The one picture that every benchmark scores, and where in it.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/frame.hpp"
#include "engine/window.hpp"

namespace fathom::bench {

/// 1024 x 768 random pixels, the same on every call: larger than any L1 cache.
Frame random_frame(Depth depth = Depth::bits8);

/// Windows of side n scattered over that frame, the same on every call.
std::vector<Window> scattered_windows(int n, std::size_t count);

/// How many windows a batch has: enough that a call's own cost vanishes, few enough that it ends.
std::size_t batch_size(int n);

}  // namespace fathom::bench
