// SPDX-License-Identifier: Apache-2.0
// The square of a frame that a score is computed from (thesis T2).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

inline constexpr int kSmallestWindow = 8;
inline constexpr int kLargestWindow = 512;

/// Whether n is a side that the transforms take: a power of two from 8 to 512.
constexpr bool is_window_side(int n) {
  return n >= kSmallestWindow && n <= kLargestWindow && (n & (n - 1)) == 0;
}

/// A half-open square of pixels: columns x .. x+n-1 and rows y .. y+n-1.
struct Window {
  int x = 0;  ///< Left column, px.
  int y = 0;  ///< Top row, px.
  int n = 0;  ///< Side, px.

  bool operator==(const Window&) const = default;
};

/// Whether the window lies wholly inside a picture of this size.
bool fits(const Window& window, int width_px, int height_px);

/// Throws Error(bad_argument) for a side that is no power of two from 8 to 512, and
/// Error(out_of_bounds), naming a window that would fit, where this one crosses the edge (thesis T2
/// refuses 64 x 64 at (200, 200) of 256 x 256).
void require_fits(const Window& window, int width_px, int height_px);

/// The window of side n in the middle of a picture. Throws as require_fits does.
Window centred_window(int width_px, int height_px, int n);

/// The first window and every one of its side that lies whole strides to the right of it or below,
/// row by row: a value that knows its windows without holding them.
class WindowGrid {
 public:
  /// Throws Error(bad_argument) for a stride below 1, and as require_fits for the first window.
  WindowGrid(int width_px, int height_px, const Window& first, int stride_px);

  std::size_t size() const { return static_cast<std::size_t>(columns_) * rows_; }

  /// Window number i, i < size(). Unchecked.
  Window operator[](std::size_t i) const {
    const int row = static_cast<int>(i / columns_);
    const int column = static_cast<int>(i % columns_);
    return {first_.x + column * stride_px_, first_.y + row * stride_px_, first_.n};
  }

 private:
  Window first_;
  int stride_px_;
  int columns_;
  int rows_;
};

/// All windows of a WindowGrid. Throws as its constructor.
std::vector<Window> window_grid(int width_px, int height_px, const Window& first, int stride_px);

/// Reads "X,Y,N". Throws Error(bad_argument) for anything else, also a side that no transform
/// takes.
Window parse_window(std::string_view text);

/// "X,Y,N", what parse_window reads.
std::string to_string(const Window& window);

}  // namespace fathom
