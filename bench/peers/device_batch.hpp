// SPDX-License-Identifier: Apache-2.0
// What peers on a device share: how many windows at once, and where these start.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/frame.hpp"
#include "engine/window.hpp"

namespace fathom::bench {

/// Windows that are transformed at once: more only make its memory larger.
inline std::size_t device_batch(int n) {
  const auto side = static_cast<std::size_t>(n);
  return std::clamp<std::size_t>((std::size_t{1} << 23) / (side * side), 16, 1024);
}

/// The bytes of an 8-bit frame where windows start.
inline std::vector<std::uint32_t> window_origins(const Frame& frame,
                                                 std::span<const Window> windows) {
  std::vector<std::uint32_t> origins;
  for (const Window& window : windows) {
    origins.push_back(
        static_cast<std::uint32_t>(static_cast<std::size_t>(window.y) * frame.stride_bytes() +
                                   static_cast<std::size_t>(window.x)));
  }
  return origins;
}

}  // namespace fathom::bench
