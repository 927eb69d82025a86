// SPDX-License-Identifier: Apache-2.0
// Random frames by the gigabyte, and windows that tile them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/frame.hpp"
#include "engine/window.hpp"

namespace fathom::bench {

/// A frame that windows tile without overlap or gap, so that every pixel is uploaded once.
struct Tiles {
  int n = 0;  ///< Side of a window, px.
  int columns = 0;
  int rows = 0;

  /// As square as exactly so many windows can be laid.
  static Tiles of(int n, std::size_t windows);

  std::size_t windows() const { return static_cast<std::size_t>(columns) * rows; }
  std::size_t bytes(Depth depth) const { return windows() * n * n * bytes_per_pixel(depth); }
  std::vector<Window> list() const;
};

/// One long row of random bytes, in which every frame is a view from another byte on.
class Pixels {
 public:
  /// most_bytes: the largest frame; there is more, so that frames in turn do not stay in a cache.
  explicit Pixels(std::size_t most_bytes);

  /// Frame number 0, 1, 2, .. of this shape; they repeat after some, but never the next one.
  Frame frame(std::size_t number, const Tiles& tiles, Depth depth) const;

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace fathom::bench
