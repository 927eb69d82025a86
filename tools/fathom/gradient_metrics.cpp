// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/gradient_metrics.hpp"

#include <cstddef>
#include <vector>

namespace fathom {
namespace {

/// A window's pixels with one mirrored line round them.
class Bordered {
 public:
  Bordered(const Frame& frame, const Window& window)
      : n_(window.n), pixels_(static_cast<std::size_t>(n_ + 2) * (n_ + 2)) {
    for (int y = -1; y <= n_; ++y) {
      for (int x = -1; x <= n_; ++x) {
        pixels_[place(x, y)] =
            static_cast<int>(frame.at(window.x + mirrored(x), window.y + mirrored(y)));
      }
    }
  }

  /// -1 <= x, y <= n.
  int operator()(int x, int y) const { return pixels_[place(x, y)]; }

 private:
  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y + 1) * (n_ + 2) + x + 1;
  }
  int mirrored(int at) const {
    if (at < 0) return -at;
    return at < n_ ? at : 2 * (n_ - 1) - at;
  }

  int n_;
  std::vector<int> pixels_;
};

}  // namespace

double laplacian_variance(const Frame& frame, const Window& window) {
  const Bordered p(frame, window);
  double sum = 0, squares = 0;
  for (int y = 0; y < window.n; ++y) {
    for (int x = 0; x < window.n; ++x) {
      const double value = p(x - 1, y) + p(x + 1, y) + p(x, y - 1) + p(x, y + 1) - 4 * p(x, y);
      sum += value;
      squares += value * value;
    }
  }
  const double count = static_cast<double>(window.n) * window.n;
  return squares / count - sum / count * (sum / count);
}

double tenengrad(const Frame& frame, const Window& window) {
  const Bordered p(frame, window);
  double squares = 0;
  for (int y = 0; y < window.n; ++y) {
    for (int x = 0; x < window.n; ++x) {
      double gx = 0, gy = 0;
      for (const int side : {-1, 0, 1}) {
        const int weight = side == 0 ? 2 : 1;
        gx += weight * (p(x + 1, y + side) - p(x - 1, y + side));
        gy += weight * (p(x + side, y + 1) - p(x + side, y - 1));
      }
      squares += gx * gx + gy * gy;
    }
  }
  return squares / (static_cast<double>(window.n) * window.n);
}

}  // namespace fathom
