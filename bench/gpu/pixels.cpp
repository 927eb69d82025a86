// SPDX-License-Identifier: Apache-2.0
#include "bench/gpu/pixels.hpp"

#include "bench/gpu/common.hpp"

namespace fathom::bench {
Tiles Tiles::of(int n, std::size_t windows) {
  const std::size_t rows = tile_rows(windows);
  return {n, static_cast<int>(windows / rows), static_cast<int>(rows)};
}

std::vector<Window> Tiles::list() const { return window_grid(columns * n, rows * n, {0, 0, n}, n); }

Pixels::Pixels(std::size_t most_bytes) : words_((most_bytes + kSpareBytes) / 8) {
  for (std::size_t i = 0; i < words_.size(); ++i) words_[i] = random_word(i);
}

Frame Pixels::frame(std::size_t number, const Tiles& tiles, Depth depth) const {
  const auto* const first = reinterpret_cast<const std::byte*>(words_.data());
  const int width_px = tiles.columns * tiles.n;
  return Frame::view(first + frame_offset(number, tiles.bytes(depth), words_.size() * 8), width_px,
                     tiles.rows * tiles.n, depth, width_px * bytes_per_pixel(depth));
}

}  // namespace fathom::bench
