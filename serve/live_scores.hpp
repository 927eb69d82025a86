// SPDX-License-Identifier: Apache-2.0
// The score of several windows of different sides in each picture.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/scorer.hpp"

namespace fathom::serve {

class LiveScores {
 public:
  /// metric: as MetricSpec::parse takes it, with one number a window. Throws as that does, as
  /// require_fits and select_device, and Error(bad_argument) for no window, or more than kMost.
  LiveScores(const std::string& metric, std::vector<Window> windows, int width_px, int height_px,
             const std::string& backend, const DeviceOptions& device);

  static constexpr std::size_t kMost = 64;

  const std::vector<Window>& windows() const { return windows_; }
  /// One number a window.
  std::vector<double> of(const Frame& frame);
  /// An N x N picture of the first window's magnitudes, 80 dB, with the zero frequency where its
  /// transform has it.
  std::vector<std::uint8_t> spectrum(const Frame& frame);

 private:
  std::vector<Window> windows_;
  std::vector<std::unique_ptr<Scorer>> scorers_;  // one a window
  std::unique_ptr<Plan> plan_;                    // of the first one's device
};

}  // namespace fathom::serve
