// SPDX-License-Identifier: Apache-2.0
// What a rig is, measured with the rig itself: its frames, its settling, its backlash, and what its
// file should say of them. Each step gives values; the caller tells them as they come.
#pragma once

#include <optional>

#include "../focus/focus.hpp"
#include "backlash.hpp"
#include "observer.hpp"
#include "rig.hpp"
#include "settling.hpp"

namespace fathom {

/// What the camera gives while the lens stands still.
struct CameraCheck {
  double frames_per_s = 0;    ///< 0 where the stamps do not tell.
  FrameCounts counts;         ///< Since the camera was opened.
  double repeat_scatter = 0;  ///< Of a score, relative; 0 for a camera that is not live.
  double saturated = 0;       ///< Part of the window's pixels at the maximum, 0..1.
};

/// Takes some frames where the lens stands. Throws as Rig::measure, like everything below.
CameraCheck check_camera(Rig& rig);

/// Whether a focus has one clear peak with a width: settling and backlash are measured on its
/// slopes.
bool has_curve(const Focus& focus);

/// How long frames are watched after a move, ms: doubled while they still change, up to the latter.
inline constexpr double kFirstWatch_ms = 750;
inline constexpr double kLongestWatch_ms = 12'000;

/// The longest of what a long and a short move take, from either side, the lens resting `rest_ms`
/// before each; nothing where frames still change after the longest watch. focus: has_curve().
std::optional<Settling> slowest_settling(Rig& rig, const Focus& focus, double rest_ms);

/// How long the lens itself waits after the motor's stop, ms. Moves to the focus.
double waiting_ms(Rig& rig, const Focus& focus);

/// The backlash that the lens leaves, measured round a focus that has_curve().
Backlash backlash_round(Rig& rig, const Focus& focus);

/// The same rig opened anew, with a lens that neither waits nor takes up its play, but for
/// `settle_ms` after the motor's stop. options.rig: of a lens with traits (hal/lens_traits.hpp).
Rig bare_rig(const RigOptions& options, double settle_ms);

/// What a rig file should say: how long to wait, ms, with a frame's interval more, because another
/// time the frames fall differently.
double suggested_settle_ms(const Settling& bare);
/// The widest spacing of which one sample at least lies on the upper half of the peak, in the
/// lens's unit. focus: has_curve().
double suggested_coarse(const Focus& focus, double resolution);

}  // namespace fathom
