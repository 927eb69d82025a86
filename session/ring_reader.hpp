// SPDX-License-Identifier: Apache-2.0
// Ring powers of a picture, for a search by spectra.
#pragma once

#include <vector>

#include "../engine/scorer.hpp"
#include "../focus/sample.hpp"

namespace fathom {

/// What ring powers are read by: fft:N:hann:power:rings=K, K = rings_of_side(side) > 0.
MetricSpec rings_metric(int side);

/// Looks at the window that is scored, and at one twice as wide round the same middle, shifted only
/// as far as the picture's edges ask for.
class RingReader {
 public:
  /// window: of the score. Where that has no rings (focus/blur.hpp) nothing is read; a wide one
  /// that has none, or does not fit the picture, is left out. Throws as select_device.
  RingReader(const Window& window, int width_px, int height_px);

  /// Throws as Scorer::score.
  std::vector<RingPowers> read(const Frame& frame);

  /// Whether there is any side to look at.
  bool can_read() const { return !scorers_.empty(); }

 private:
  std::vector<Scorer> scorers_;
  std::vector<double> values_;
};

}  // namespace fathom
