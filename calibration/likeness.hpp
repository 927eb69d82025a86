// SPDX-License-Identifier: Apache-2.0
// How far what is ranged now is from what was calibrated: the object by its spectrum, the metric
// and the window by name.
//
// A lens focuses on some depth within an object, and a tape measures to another. On the calibrated
// object the difference is part of the curve. On another object it is anything that the curve
// cannot show: relief that is shallow beside the width of the peak.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "../focus/peak.hpp"
#include "calibration.hpp"

namespace fathom {

/// How many rings an object's spectrum has (docs/metrics.md, "Rings").
inline constexpr int kSpectrumRings = 8;

/// How far the spectra of two objects are apart, whatever their brightness and contrast: the root
/// mean square over the rings of ln(a / b), less its mean. Nothing where the sizes differ, or a
/// ring of either is not above 0.
std::optional<double> spectra_apart(std::span<const double> a, std::span<const double> b);

/// What a range has that its calibration has not.
struct Likeness {
  /// spectra_apart() from the object that was calibrated, as it looks at this position; absent
  /// where either spectrum is unknown.
  std::optional<double> apart;
  /// By how much that is beyond what the calibrated object differs from itself, 0 alike .. 1 wholly
  /// another; 0 where it is unknown.
  double other_object = 0;
  bool other_metric = false;
  bool other_window = false;
  /// Standard uncertainty that follows, in the lens's unit: no repetition makes it smaller.
  double sigma = 0;
};

/// spectrum: of the object, at the peak; may be empty. now: what is measured with; what either side
/// does not know is not compared.
Likeness likeness_of(const Calibration& calibration, const Peak& peak,
                     std::span<const double> spectrum, const CalibrationConditions& now);

}  // namespace fathom
