// SPDX-License-Identifier: Apache-2.0
#include "bench/scene.hpp"

#include <algorithm>
#include <cstdint>
#include <random>
#include <utility>

namespace fathom::bench {
namespace {

constexpr int kWidth_px = 1024;
constexpr int kHeight_px = 768;

/// 0 .. limit - 1, the same with every standard library, as its distributions are not.
int below(std::mt19937& random, int limit) {
  return static_cast<int>(static_cast<std::uint64_t>(random()) * limit >> 32);
}

template <class Pixel>
Frame random_frame_of() {
  std::mt19937 random(1989);
  std::vector<Pixel> pixels(static_cast<std::size_t>(kWidth_px) * kHeight_px);
  for (auto& pixel : pixels) pixel = static_cast<Pixel>(below(random, 1 << (8 * sizeof(Pixel))));
  return Frame(kWidth_px, kHeight_px, std::move(pixels));
}

}  // namespace

Frame random_frame(Depth depth) {
  return depth == Depth::bits8 ? random_frame_of<std::uint8_t>() : random_frame_of<std::uint16_t>();
}

std::vector<Window> scattered_windows(int n, std::size_t count) {
  std::mt19937 random(64);
  std::vector<Window> windows(count);
  for (Window& window : windows) {
    window = {below(random, kWidth_px - n + 1), below(random, kHeight_px - n + 1), n};
  }
  return windows;
}

std::size_t batch_size(int n) {
  constexpr std::size_t kMost = 4096;
  const std::size_t of_equal_pixels = kMost * 64 * 64 / (static_cast<std::size_t>(n) * n);
  return std::min(kMost, of_equal_pixels);
}

}  // namespace fathom::bench
