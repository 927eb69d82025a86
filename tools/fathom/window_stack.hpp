// SPDX-License-Identifier: Apache-2.0
// One window of a stack of pictures, kept so that many metrics can look at the same pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/frame.hpp"
#include "engine/window.hpp"

namespace fathom {

/// The pixels of a window at every lens position, side by side in one frame.
class WindowStack {
 public:
  /// n: side of the window, px.
  WindowStack(int n, Depth depth) : n_(n), depth_(depth) {}

  /// Copies the window's pixels. Throws Error(bad_argument) for a frame of another depth.
  void add(double position, const Frame& frame, const Window& window);

  int n() const { return n_; }
  std::size_t size() const { return positions_.size(); }
  const std::vector<double>& positions() const { return positions_; }

  /// Mean grey value of the whole of the picture that was added last; 0 where nobody says.
  void set_light(double light) { lights_.back() = light; }
  const std::vector<double>& lights() const { return lights_; }

  /// The pictures' windows in frame(), in the order in which they were added.
  std::vector<Window> windows() const;
  /// All pictures, size() times n px wide and n high.
  Frame frame() const;

  /// The same pictures with noise of this deviation in grey levels on every pixel, rounded and
  /// kept within the depth. The same for the same seed, on every machine.
  WindowStack with_noise(double deviation, std::uint64_t seed) const;

  /// One of the pictures, so many times.
  WindowStack repeated(std::size_t index, std::size_t times) const;

 private:
  std::uint16_t& at(std::size_t index, int x, int y) {
    return pixels_[(index * n_ + y) * static_cast<std::size_t>(n_) + x];
  }

  int n_;
  Depth depth_;
  std::vector<double> positions_;
  std::vector<double> lights_;
  std::vector<std::uint16_t> pixels_;  ///< [picture][y][x]
};

/// Deviation of the noise of pictures that show the same scene: of the differences between each
/// and the next, over the root of 2, in grey levels. 0 for fewer than two.
double repeat_noise(const WindowStack& repeated);

}  // namespace fathom
