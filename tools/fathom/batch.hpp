// SPDX-License-Identifier: Apache-2.0
// How many windows a plan is given at a time.
#pragma once

#include <algorithm>
#include <cstddef>

namespace fathom::cli {

/// Windows of side n that fill any device, whose pixels (16 Mi at most) and rows take little
/// memory.
constexpr std::size_t full_batch(int n) {
  constexpr std::size_t kMostWindows = 4096, kMostPixels = std::size_t{1} << 24;
  return std::min(kMostWindows, kMostPixels / (static_cast<std::size_t>(n) * n));
}

}  // namespace fathom::cli
