// SPDX-License-Identifier: Apache-2.0
// Whether a curve has a focus, one only, and how sure that is.
#pragma once

#include <span>

#include "curve.hpp"
#include "noise.hpp"
#include "part_light.hpp"
#include "parts.hpp"
#include "peak.hpp"
#include "second_look.hpp"

namespace fathom {

enum class FocusResult {
  focused,   ///< One peak that stands out of the noise, inside of what was searched.
  no_focus,  ///< Nothing that noise alone would not give (a blank card; thesis: a patch of orange).
  at_limit,  ///< The best position is the first or last searched: the focus may lie beyond.
  ambiguous,  ///< Two peaks of like height: two objects, or two sharp planes.
};

/// "focused", "no-focus", "at-limit", "ambiguous".
const char* to_string(FocusResult result) noexcept;

/// What decided.
enum class Why {
  unknown,         ///< Nobody has judged, or only words were kept.
  stands_out,      ///< The peak stands high enough above the noise at the floor.
  by_spectra,      ///< The spectra defocus as the law says, though the scores drown in noise.
  too_few_frames,  ///< The frames that were allowed do not tell.
  dead_pictures,   ///< So many pictures are black or saturated that there is no floor.
  one_position,    ///< A single position was evaluated.
  few_pictures,    ///< Fewer than kFewestLive positions were evaluated.
  all_alike,       ///< Every position has the very same score.
  too_wild,        ///< So few coefficients scatter too much to judge by.
  within_noise,    ///< The scores rise no more than noise alone may make them.
  small_rise,      ///< The scores rise, but by less than a lamp that drifts may make them.
  light_changed,   ///< The scores rise with the brightness of the pictures, not with sharpness.
  light_in_part,   ///< The scores rise with the brightness of parts of the window.
  noise_changed,   ///< The scores rise because the pictures become noisier.
  too_faint,       ///< What rises is less than the camera's grey levels tell.
  no_shape,        ///< The scores rise, but no peak's shape describes them.
  unsure,          ///< A peak, but its confidence is below kLeastConfidence.
  at_end,          ///< The best score is at an end of what was searched.
  unshared,        ///< No other picture shows what the best one shows (resemblance.hpp).
  changed,         ///< What was seen at one time does not fit what was seen at another.
  two_depths,      ///< Parts of the window are sharp where others are not.
  two_peaks,       ///< The second peak is at least kAmbiguousHeight as high.
};
inline constexpr Why kWhys[] = {
    Why::unknown,       Why::stands_out,    Why::by_spectra,   Why::too_few_frames,
    Why::dead_pictures, Why::one_position,  Why::few_pictures, Why::all_alike,
    Why::too_wild,      Why::within_noise,  Why::small_rise,   Why::light_changed,
    Why::light_in_part, Why::noise_changed, Why::too_faint,    Why::no_shape,
    Why::unsure,        Why::at_end,        Why::unshared,     Why::changed,
    Why::two_depths,    Why::two_peaks};

/// "stands-out", "dead-pictures" and so on: the names above with hyphens.
const char* to_string(Why why) noexcept;

/// Why a verdict is what it is. All numbers are filled, whatever decided; each front end puts them
/// into words of its own.
struct Reason {
  Why why = Why::unknown;
  double position = 0;          ///< Of the highest peak; at_end: of the end with the higher score.
  double r_squared = 0;         ///< Of the highest peak; 0 where no points are left to judge it by.
  double confidence = 0;        ///< As in Verdict, but not 0 where that is why there is no focus.
  double second_position = 0;   ///< Of the second peak; 0 if there is none.
  double second_part = 0;       ///< Its height over that of the highest, 0..1.
  double contrast = 0;          ///< (best - lowest) / best of the scores, 0..1.
  bool is_live = false;         ///< Whether pictures can be taken again, or averaged.
  bool at_lens_end = false;     ///< at_end: the lens goes no farther.
  bool whole_travel = false;    ///< There is nowhere else to search,
  bool largest_window = false;  ///< nor a larger window in the picture.
  double saturated = 0;         ///< Part of the best picture's pixels, 0..1.
  double light_left = 1;        ///< PartLight::left.
  Transform transform = Transform::fft;  ///< Of the metric.
  int evaluations = 0;                   ///< In the curve,
  int dead = 0;  ///< and how many of them are of black or saturated pictures.

  bool operator==(const Reason&) const = default;
};

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
  ///   1 - second / first    heights of the two highest lobes above the floor; 1 with one lobe;
  ///   1 - saturated         of the best picture, whose saturated pixels show nothing;
  ///   PartLight::left       where the light of parts of the window changed.
  /// Halved where a single picture of a recording shows the peak, and less for a spread of depths.
  /// 0 unless focused or ambiguous. Ratios only: neither the light nor the part of the window that
  /// the object fills changes it, as long as the noise stays far below.
  double confidence = 0;
  Reason reason;
};

/// Stands for R^2 in the confidence of a peak without points to judge its shape by.
inline constexpr double kUnjudged = 0.8;

/// What speaks against a peak beside its curve.
struct Doubts {
  SecondLooks looks;
  Depths depths;
  bool is_live = false;  ///< Whether second looks could be taken.
  double saturated = 0;  ///< Part of the best picture's pixels, 0..1.
  PartLight light = {};
  double light_shift =
      0;  ///< How far the answer depends on what the light did, in the lens's unit.
};

/// Judges a curve that is not empty. raw: the same in the light that there was; peaks: of its lobes,
/// the highest first, at least one.
Verdict judge(const FocusCurve& curve, const FocusCurve& raw, std::span<const Peak> peaks,
              const Scatter& scatter, const Doubts& doubts = {});

}  // namespace fathom
