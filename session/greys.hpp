// SPDX-License-Identifier: Apache-2.0
// The grey values of a window as whole numbers, which loops go over fast.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "../engine/frame.hpp"
#include "../engine/window.hpp"

namespace fathom {

/// Calls visit(const Pixel*) with each row of the window, Pixel being std::uint8_t or std::uint16_t.
/// Rows of 16-bit pixels that may not be aligned are copied first.
template <class Visit>
void for_each_row(const Frame& frame, const Window& window, Visit visit) {
  const auto n = static_cast<std::size_t>(window.n), left = static_cast<std::size_t>(window.x);
  std::vector<std::uint16_t> copy(frame.depth() == Depth::bits16 ? n : 0);
  for (int y = window.y; y < window.y + window.n; ++y) {
    const std::byte* const row = frame.row(y);
    if (frame.depth() == Depth::bits8) {
      visit(reinterpret_cast<const std::uint8_t*>(row) + left);
    } else {
      std::memcpy(copy.data(), row + left * sizeof(std::uint16_t), n * sizeof(std::uint16_t));
      visit(copy.data());
    }
  }
}

/// n x n grey values, row by row. The window must lie inside of the frame.
inline void read_greys(const Frame& frame, const Window& window, std::vector<std::int32_t>& greys) {
  greys.resize(static_cast<std::size_t>(window.n) * window.n);
  auto* to = greys.data();
  const int n = window.n;
  for_each_row(frame, window, [&to, n](const auto* row) {
    std::int32_t* const line = to;  // bytes may alias `to` itself
    for (int x = 0; x < n; ++x) line[x] = row[x];
    to += n;
  });
}

}  // namespace fathom
