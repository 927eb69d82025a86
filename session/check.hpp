// SPDX-License-Identifier: Apache-2.0
// What a rig is, measured with the rig itself: its frames, its settling, its backlash, and what its
// file should say of them. Each step gives values; the caller tells them as they come.
#pragma once

#include <functional>
#include <optional>

#include "../focus/focus.hpp"
#include "backlash.hpp"
#include "hill.hpp"
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

/// Whether a focus has one clear peak with a width.
bool has_curve(const Focus& focus);

/// How long frames are watched after a move, ms: longer while they still change, up to the latter;
/// twice that where the driver does not wait for its motor.
inline constexpr double kFirstWatch_ms = 750;
inline constexpr double kLongestWatch_ms = 24'000;

/// How long frames see the lens move after its motor's stop.
struct Lag {
  Settling slowest;     ///< Of a long and a short move, from either side.
  double least_ms = 0;  ///< After the shortest way;
  double per_unit_ms =
      0;  ///< and so much more for each unit of the lens. Above 0 for a driver that
          ///< says that the lens is there while it is still on its way.
  double after(double distance) const { return least_ms + per_unit_ms * distance; }
};

/// Told before each move that is watched: how long that takes, with the rest before it, ms.
using WatchNews = std::function<void(double from, double to, double takes_ms)>;

/// Moves to the slope of a hill from either side, from afar and from near by. Nothing where frames
/// still change after the longest watch.
std::optional<Lag> measure_lag(Rig& rig, const Hill& hill, const WatchNews& watching = {});

/// How long the lens itself waits after the motor's stop, ms. Moves to the hill.
double waiting_ms(Rig& rig, const Hill& hill);

/// What a rig file says of its lens (hal/lens_traits.hpp).
struct LensSettings {
  double settle_ms = 0;
  double backlash = 0;
  double coarse = 0;  ///< 0: as the file says.
};

/// The same rig opened anew, with other settings of its lens; at first one that neither waits nor
/// takes up its play. options.rig: of a lens with traits.
Rig rig_with(const RigOptions& options, const LensSettings& settings);

/// What a rig file should say: how long to wait after the longest way, ms, with a frame's interval
/// more, because another time the frames fall differently.
double suggested_settle_ms(const Lag& bare, const LensInfo& lens);
/// The widest spacing of which one sample at least lies on the upper half of the peak, in the
/// lens's unit.
double suggested_coarse(const Hill& hill, double resolution);

}  // namespace fathom
