// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/batch.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace fathom::gpu {

void Rectangle::include(const Window& window) {
  if (right == 0) *this = {window.x, window.y, window.x + window.n, window.y + window.n};
  x = std::min(x, window.x);
  y = std::min(y, window.y);
  right = std::max(right, window.x + window.n);
  bottom = std::max(bottom, window.y + window.n);
}

std::size_t Rectangle::stride_bytes(Depth depth) const {
  return (static_cast<std::size_t>(right - x) * bytes_per_pixel(depth) + 3) / 4 * 4;
}

std::size_t Rectangle::bytes(Depth depth) const {
  return stride_bytes(depth) * static_cast<std::size_t>(bottom - y);
}

void Rectangle::copy(const Frame& frame, std::byte* packed) const {
  const std::size_t pixel = bytes_per_pixel(frame.depth()), stride = stride_bytes(frame.depth());
  for (int row = y; row < bottom; ++row) {
    std::memcpy(packed, frame.row(row) + static_cast<std::size_t>(x) * pixel,
                static_cast<std::size_t>(right - x) * pixel);
    packed += stride;
  }
}

std::uint32_t Rectangle::origin(const Window& window, Depth depth) const {
  return static_cast<std::uint32_t>(static_cast<std::size_t>(window.y - y) * stride_bytes(depth) +
                                    static_cast<std::size_t>(window.x - x) *
                                        bytes_per_pixel(depth));
}

std::vector<Batch> cut(std::span<const Window> windows, Depth depth, std::size_t most,
                       std::size_t room) {
  std::vector<std::uint32_t> order(windows.size());
  std::iota(order.begin(), order.end(), 0);
  Rectangle all;
  for (const Window& window : windows) all.include(window);
  if (all.bytes(depth) > room) {
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return windows[a].y < windows[b].y; });
  }
  std::vector<Batch> batches;
  for (const std::uint32_t id : order) {
    Rectangle larger = batches.empty() ? Rectangle() : batches.back().part;
    larger.include(windows[id]);
    if (batches.empty() || batches.back().ids.size() == most || larger.bytes(depth) > room) {
      batches.emplace_back();
      larger = {};
      larger.include(windows[id]);
    }
    batches.back().part = larger;
    batches.back().ids.push_back(id);
  }
  return batches;
}

}  // namespace fathom::gpu
