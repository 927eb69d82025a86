// SPDX-License-Identifier: Apache-2.0
// What a picture tells beside its score.
#pragma once

#include <algorithm>
#include <complex>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "../engine/backend.hpp"
#include "../focus/sample.hpp"
#include "lowest_coefficients.hpp"

namespace fathom {

/// What a window's brightness adds to its score through the taper: a constant under one is no
/// impulse, but fills the lowest coefficients, too (docs/metrics.md, "Brightness").
class BrightnessShare {
 public:
  /// spec: of a moment. The device must outlive this. Throws as Device::plan.
  BrightnessShare(Device& device, const MetricSpec& spec);

  /// What is left of a score without this share; never below 0, though rounding may say so.
  static double without(double score, double share) { return std::max(0.0, score - share); }

  /// The score less that of the same window with its weighted mean subtracted before the taper, in
  /// the units of the score; 0 for a metric without taper. Throws as Plan::score.
  double of(const Frame& frame, const Window& window);

 private:
  /// A coefficient that a constant reaches.
  struct Place {
    std::size_t at;                 ///< In the spectrum.
    double weight;                  ///< In the moment.
    std::complex<double> constant;  ///< What it is for a constant, over that of zero frequency.
  };

  /// Under a raised cosine, which needs no more than the lowest coefficients.
  void begin_lowest(const std::vector<double>& weights);
  void begin_whole(Device& device, const std::vector<double>& weights);
  /// weight: in the moment, of the transform's own storage; constant: of a picture of one grey value.
  void add_place(std::size_t at, double weight, std::complex<double> constant,
                 std::complex<double> zero);
  /// Coefficients of a window, of which places_ and zero_ say where they stand.
  void read(const Frame& frame, const Window& window);

  MetricSpec spec_;
  std::optional<LowestCoefficients> lowest_;  // one of these two, or
  std::unique_ptr<Plan> plan_;                // none where brightness has no share
  std::vector<Place> places_;
  std::size_t zero_ = 0;  // where zero frequency stands in the spectrum
  std::vector<std::complex<double>> spectrum_;
};

/// Learns the PictureFacts of one window; its parts are scored on the same device.
class PictureReader {
 public:
  /// Parts are left out where half the side is no window of the metric. The device must outlive this.
  PictureReader(Device& device, const MetricSpec& spec, const Window& window);

  /// Throws as Plan::score.
  PictureFacts read(const Frame& frame);

 private:
  Window window_;
  std::unique_ptr<Plan> plan_;  // absent where there are no parts, as is
  std::optional<BrightnessShare> share_;
  std::vector<Window> parts_;
  std::vector<std::int32_t> greys_;  // of the window, for one picture
};

}  // namespace fathom
