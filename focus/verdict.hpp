// SPDX-License-Identifier: Apache-2.0
// Whether a curve has a focus, one only, and how sure that is.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "noise.hpp"
#include "peak.hpp"
#include "search.hpp"

namespace fathom {

enum class FocusResult {
  focused,   ///< One peak that stands out of the noise, inside of what was searched.
  no_focus,  ///< Nothing that noise alone would not give (a blank card; thesis: a patch of orange).
  at_limit,  ///< The best position is the first or last searched: the focus may lie beyond.
  ambiguous,  ///< Two peaks of like height: two objects, or two sharp planes.
};

/// "focused", "no-focus", "at-limit", "ambiguous".
const char* to_string(FocusResult result) noexcept;

/// Another peak is as good as the best one from this part of its height on.
inline constexpr double kAmbiguousHeight = 0.4;
/// A curve of which a shape explains less than this part of the variance is no peak, unless so many
/// points say the same that it cannot be chance (F test at 1 %).
inline constexpr double kLeastRSquared = 0.5;

/// A focus that is less sure than this is none.
inline constexpr double kLeastConfidence = 0.15;

/// What a search has come to.
struct Verdict {
  FocusResult result = FocusResult::no_focus;
  Rise rise;
  /// How sure the focus is, 0..1: the product of
  ///   1 - needed / rise     far above the noise is near 1, at what noise might do 0;
  ///   R^2 of the peak       1 where the shape explains all; kUnjudged where nothing is left over;
  ///   1 - second / first    heights of the two highest lobes above the floor; 1 with one lobe.
  /// 0 unless focused or ambiguous. Ratios only: neither the light nor the part of the window that
  /// the object fills changes it, as long as the noise stays far below.
  double confidence = 0;
  std::string reason;  ///< One line for the user.
};

/// Stands for R^2 in the confidence of a peak without points to judge its shape by.
inline constexpr double kUnjudged = 0.8;

/// Judges a curve. curve: sorted by position; peaks: of its lobes, the highest first, at least one.
Verdict judge(std::span<const Evaluation> curve, std::span<const Peak> peaks,
              const Scatter& scatter);

}  // namespace fathom
