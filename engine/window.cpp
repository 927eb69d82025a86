// SPDX-License-Identifier: Apache-2.0
#include "engine/window.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>

#include "engine/error.hpp"

namespace fathom {
namespace {

void require_side(int n) {
  if (is_window_side(n)) return;
  throw Error(
      ErrorCode::bad_argument,
      fmt::format("a window of side {} has no transform; the side must be a power of two from "
                  "{} to {}",
                  n, kSmallestWindow, kLargestWindow));
}

/// A window close to the wanted one that does fit: moved first, made smaller only if it must be.
std::string suggestion(const Window& wanted, int width_px, int height_px) {
  const int smaller_side = std::min(width_px, height_px);
  if (smaller_side < kSmallestWindow) {
    return fmt::format("the picture is smaller than the smallest window, {0} x {0}",
                       kSmallestWindow);
  }
  const int largest = static_cast<int>(
      std::bit_floor(static_cast<unsigned>(std::min(smaller_side, kLargestWindow))));
  const int n = std::min(wanted.n, largest);
  const Window near{std::clamp(wanted.x, 0, width_px - n), std::clamp(wanted.y, 0, height_px - n),
                    n};
  return fmt::format("window {} fits", to_string(near));
}

}  // namespace

bool fits(const Window& w, int width_px, int height_px) {
  return w.n > 0 && w.x >= 0 && w.y >= 0 && w.n <= width_px && w.n <= height_px &&
         w.x <= width_px - w.n && w.y <= height_px - w.n;
}

void require_fits(const Window& w, int width_px, int height_px) {
  require_side(w.n);
  if (fits(w, width_px, height_px)) return;
  throw Error(
      ErrorCode::out_of_bounds,
      fmt::format("the {0} x {0} window at {1},{2} crosses the edge of a {3} x {4} px picture; {5}",
                  w.n, w.x, w.y, width_px, height_px, suggestion(w, width_px, height_px)));
}

Window centred_window(int width_px, int height_px, int n) {
  require_side(n);
  const Window window{(width_px - n) / 2, (height_px - n) / 2, n};
  if (n > width_px || n > height_px) {
    throw Error(ErrorCode::out_of_bounds,
                fmt::format("a {0} x {0} window does not fit in a {1} x {2} px picture; {3}", n,
                            width_px, height_px, suggestion(window, width_px, height_px)));
  }
  return window;
}

WindowGrid::WindowGrid(int width_px, int height_px, const Window& first, int stride_px)
    : first_(first), stride_px_(stride_px) {
  if (stride_px < 1) {
    throw Error(
        ErrorCode::bad_argument,
        fmt::format("a grid stride of {} px never moves; it must be at least 1", stride_px));
  }
  require_fits(first, width_px, height_px);
  // Counted, because x + stride_px may pass the largest int.
  columns_ = (width_px - first.n - first.x) / stride_px + 1;
  rows_ = (height_px - first.n - first.y) / stride_px + 1;
}

std::vector<Window> window_grid(int width_px, int height_px, const Window& first, int stride_px) {
  const WindowGrid grid(width_px, height_px, first, stride_px);
  std::vector<Window> windows;
  windows.reserve(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) windows.push_back(grid[i]);
  return windows;
}

Window parse_window(std::string_view text) {
  std::array<int, 3> values{};
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto [next, problem] = std::from_chars(at, end, values[i]);
    const bool last = i + 1 == values.size();
    if (problem != std::errc() || (last ? next != end : next == end || *next != ',')) {
      throw Error(
          ErrorCode::bad_argument,
          fmt::format("\"{}\" is not a window; write X,Y,N: the left column, the top row and "
                      "the side in pixels, such as 96,88,64",
                      text));
    }
    if (!last) at = next + 1;
  }
  const Window window{values[0], values[1], values[2]};
  require_side(window.n);
  return window;
}

std::string to_string(const Window& window) {
  return fmt::format("{},{},{}", window.x, window.y, window.n);
}

}  // namespace fathom
