// SPDX-License-Identifier: Apache-2.0
// Noise that neighbouring pixels share, as cameras and files make it.
#pragma once

#include <cstdint>
#include <vector>

namespace fathom::test {

/// The same for the same seed on every machine.
class Grains {
 public:
  explicit Grains(unsigned seed) : state_(seed * 0x9E3779B97F4A7C15u + 1) {}

  /// Near to normal, of deviation 10: a sum of twelve.
  double next() {
    double sum = 0;
    for (int i = 0; i < 12; ++i) {
      state_ = state_ * 6364136223846793005u + 1442695040888963407u;
      sum += static_cast<double>(state_ >> 40) / (1 << 24) - 0.5;
    }
    return 10 * sum;
  }

  /// side x side pixels round 0, blurred by 1 2 1 this many times along both axes, on a torus.
  std::vector<double> smooth(int side, int times) {
    std::vector<double> greys(static_cast<std::size_t>(side) * side);
    for (double& grey : greys) grey = next();
    for (int i = 0; i < times; ++i) greys = along(along(greys, side, 1), side, side);
    return greys;
  }

 private:
  static std::vector<double> along(const std::vector<double>& greys, int side, int step) {
    std::vector<double> sums(greys.size());
    for (int i = 0; i < side * side; ++i) {
      const int x = i / step % side, start = i - x * step;
      sums[i] = (greys[start + (x + side - 1) % side * step] + 2 * greys[i] +
                 greys[start + (x + 1) % side * step]) /
                4;
    }
    return sums;
  }

  std::uint64_t state_;
};

}  // namespace fathom::test
