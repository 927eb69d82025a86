// SPDX-License-Identifier: Apache-2.0
// The sizes of window that a map is made of. Windows of 8 px on a picture that was halved h times are
// windows of 8 * 2^h px that leave out what is finer than they need.
#pragma once

#include <cstddef>
#include <vector>

#include "depth/mapper.hpp"

namespace fathom::depth {

/// Side of the windows that are scored, px of their picture, and their rings.
inline constexpr int kSide = 8, kRings = 4;

/// One size of window: a grid of them, whose centres are called nodes.
struct Level {
  int halvings = 0;   ///< Of its picture.
  int width_px = 0;   ///< Of its picture.
  int height_px = 0;  ///< Of its picture.
  int stride_px = 0;  ///< Between windows, of its picture.
  int columns = 0;
  int rows = 0;

  std::size_t nodes() const { return static_cast<std::size_t>(columns) * rows; }
  int scale() const { return 1 << halvings; }
  /// Side of the windows and distance between nodes, px of the whole picture.
  int side_px() const { return kSide * scale(); }
  double pitch_px() const { return stride_px * scale(); }
  /// Centre of the first window along either axis, px of the whole picture.
  double first_px() const { return (kSide * scale() - 1) / 2.0; }
};

/// Those that the options ask for, small windows first; by themselves as many as the picture is large
/// enough for, and the smallest left out where frames are so many that memory would not do. Throws
/// Error(bad_argument) for a side or a stride that cannot be.
std::vector<Level> plan_levels(int width_px, int height_px, std::size_t frames,
                               const DepthOptions& options);

}  // namespace fathom::depth
