// SPDX-License-Identifier: Apache-2.0
// Whether a search takes pictures while the lens travels: decided here and nowhere else.
#pragma once

#include "../focus/focus.hpp"
#include "observer.hpp"
#include "rig.hpp"

namespace fathom {

/// Throws Error(unsupported) for a camera that has no pictures of a lens on its way: a recorded one, or
/// one whose frames are averaged.
void require_watching_camera(Rig& rig);

/// Throws Error(bad_argument) for a wish to move that contradicts another one, and as
/// require_watching_camera.
void require_moving(Rig& rig, const FocusRequest& request);

/// Whether this search does. Where it was asked for and cannot be, the observer is told. limits: with
/// the blur, where it is known.
bool moves(Rig& rig, const FocusRequest& request, const FocusLimits& limits, Observer& observer);

}  // namespace fathom
