// SPDX-License-Identifier: Apache-2.0
// How well each place of a focus explains the ring powers of one window: the matched filter of the
// law of defocus, in closed form.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "depth/levels.hpp"
#include "focus/blur.hpp"

namespace fathom::depth {

/// Diameter of the blur at a distance u from the focus, px: the root of (px_per_unit u)^2 + offset_px2,
/// 0 where that is below 0. Discs that are smaller than a pixel blur less than a disc does, so
/// pictures may ask for an offset below 0.
struct StackBlur {
  double px_per_unit = 0;
  double offset_px2 = 0;
  BlurShape shape = BlurShape::disc;

  double diameter_px(double from_focus) const;
};

/// What is left of the power in each ring of a window of kSide at a blur of so many px of its picture.
std::array<float, kRings> ring_transfer(double diameter_px, BlurShape shape);

/// Foci that are looked at: low, low + step, ...
struct FocusGrid {
  double low = 0;
  double step = 0;
  int size = 0;

  double at(double place) const { return low + place * step; }
};

/// Coefficients in each ring.
const std::array<double, kRings>& ring_counts();

/// The law for one level, and all frames and foci.
class MatchedFilter {
 public:
  MatchedFilter(const Level& level, const StackBlur& blur, std::span<const double> positions,
                const FocusGrid& grid);

  /// powers: [ring][frame], overwritten; what is NaN is left out. Writes into told, first, [focus] by
  /// how much chi-squared falls if the focus is there: the sum over rings of the squared correlation
  /// with the law over its variance. Behind it, [frame], by how much detail a frame has more than the
  /// mean of all: its powers, each by what it tells, without any law. Sum of the rings of `likeness`
  /// is -count log(1 - correlation^2) instead, which needs no variance: for fitting the law itself.
  void explain(std::span<float> powers, std::span<float> told) const;
  void likeness(std::span<float> powers, std::span<float> likeness) const;

 private:
  template <class Take>
  void each_ring(std::span<float> powers, std::span<float> sums, const Take& take) const;

  int frames_, foci_;
  std::vector<float> law_;  ///< [ring][frame][focus], less its mean over frames, of norm 1.
};

}  // namespace fathom::depth
