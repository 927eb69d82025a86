// SPDX-License-Identifier: Apache-2.0
// That the model of matrix products gives the scores of `reference` to the last bit, and costs what
// docs/performance.md says.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

#include "backends/backends.hpp"
#include "engine/scorer.hpp"
#include "walsh_products.hpp"

namespace {

using fathom::bench::kPixels;
using fathom::bench::kSide;

using Pixel = std::function<int(int x, int y)>;

std::vector<std::uint8_t> window_of(const Pixel& pixel) {
  std::vector<std::uint8_t> pixels(kPixels);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x)
      pixels[static_cast<std::size_t>(y) * kSide + x] = static_cast<std::uint8_t>(pixel(x, y));
  }
  return pixels;
}

int wal(unsigned k, int x) { return std::popcount(k & static_cast<unsigned>(x)) % 2; }

/// Black and white as one basis function, so that one sum is as large as it can be; noise of all
/// contrasts; ramps and edges.
std::vector<std::vector<std::uint8_t>> windows() {
  std::vector<std::vector<std::uint8_t>> list;
  for (const int grey : {0, 1, 127, 128, 255})
    list.push_back(window_of([=](int, int) { return grey; }));
  for (unsigned k = 0; k < kSide; k += 7) {
    for (const unsigned l : {0u, k, 63u - k}) {
      list.push_back(window_of([=](int x, int y) { return wal(k, x) == wal(l, y) ? 255 : 0; }));
    }
  }
  list.push_back(window_of([](int x, int y) { return 2 * (x + y); }));
  list.push_back(window_of([](int x, int y) { return x < 20 || y > 50 ? 255 : 3; }));
  std::mt19937 random(1989);
  for (const int contrast : {1, 2, 16, 255}) {
    for (int i = 0; i < 10; ++i) {
      list.push_back(
          window_of([&](int, int) { return static_cast<int>(random() % (contrast + 1)); }));
    }
  }
  return list;
}

}  // namespace

int main() {
  const fathom::MetricSpec spec = fathom::MetricSpec::parse("walsh-sequency:64");
  fathom::Scorer scorer(fathom::select_device(fathom::all_backends(), "reference", spec, 1), spec,
                        fathom::Window{0, 0, kSide});
  int wrong = 0, count = 0;
  double largest = 0;
  for (std::vector<std::uint8_t>& pixels : windows()) {
    fathom::bench::TileProducts tiles;
    const double ours = static_cast<double>(fathom::bench::walsh_sum(
                            std::span<const std::uint8_t, kPixels>(pixels), tiles)) /
                        std::pow(kSide, 6);
    const double theirs = scorer.score(fathom::Frame(kSide, kSide, pixels));
    ++count;
    largest = std::max(largest, theirs);
    if (std::bit_cast<std::uint64_t>(ours) != std::bit_cast<std::uint64_t>(theirs)) {
      fmt::print("window {}: {:.17g}, and reference says {:.17g}\n", count - 1, ours, theirs);
      ++wrong;
    }
    if (tiles.counts().instructions != 192 || tiles.counts().products != 786432) {
      fmt::print("window {}: {} instructions, {} products\n", count - 1,
                 tiles.counts().instructions, tiles.counts().products);
      ++wrong;
    }
  }
  fmt::print("{} of {} windows agree with reference to the last bit, scores up to {:.4g}\n",
             count - wrong, count, largest);
  return wrong == 0 && largest > 0 ? 0 : 1;
}
