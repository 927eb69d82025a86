// SPDX-License-Identifier: Apache-2.0
#include "bench/opencv/opencv.hpp"

namespace fathom::bench {
namespace {

/// A window's pixels, and beyond its border the mirrored ones.
class Pixels {
 public:
  Pixels(const Frame& frame, const Window& window) : frame_(frame), window_(window) {}

  int operator()(int x, int y) const {
    const std::byte* const row = frame_.row(window_.y + mirrored(y));
    return static_cast<int>(row[window_.x + mirrored(x)]);
  }

 private:
  int mirrored(int at) const {
    if (at < 0) return -at;
    return at < window_.n ? at : 2 * (window_.n - 1) - at;
  }

  const Frame& frame_;
  const Window& window_;
};

}  // namespace

double plain_laplacian_variance(const Frame& frame, const Window& window) {
  const Pixels p(frame, window);
  double sum = 0, squares = 0;
  for (int y = 0; y < window.n; ++y) {
    for (int x = 0; x < window.n; ++x) {
      const double value = p(x - 1, y) + p(x + 1, y) + p(x, y - 1) + p(x, y + 1) - 4 * p(x, y);
      sum += value;
      squares += value * value;
    }
  }
  const double count = double(window.n) * window.n;
  return squares / count - sum / count * (sum / count);
}

double plain_tenengrad(const Frame& frame, const Window& window) {
  const Pixels p(frame, window);
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
  return squares / (double(window.n) * window.n);
}

}  // namespace fathom::bench
