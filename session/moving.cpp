// SPDX-License-Identifier: Apache-2.0
#include "session/moving.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"

namespace fathom {
namespace {

bool is_by_spectra(SearchMethod search) {
  return search == SearchMethod::automatic || search == SearchMethod::spectral;
}

}  // namespace

void require_watching_camera(Rig& rig) {
  if (!rig.camera().is_live()) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} is no live camera: it has no pictures of a lens on its way",
                            rig.camera().description()));
  }
  if (rig.options().shot.average > 1) {
    throw Error(ErrorCode::bad_argument,
                "frames of a lens on its way are of different places, and cannot be averaged");
  }
}

void require_moving(Rig& rig, const FocusRequest& request) {
  if (!request.moving.value_or(false)) return;
  if (!is_by_spectra(request.search)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a search by {} needs a halt at every position; one that moves is by "
                            "spectra",
                            to_string(request.search)));
  }
  if (request.frames) {
    throw Error(
        ErrorCode::bad_argument,
        "a number of frames is for a search that halts for each; one that moves takes many");
  }
  require_watching_camera(rig);
}

bool moves(Rig& rig, const FocusRequest& request, const FocusLimits& limits, Observer& observer) {
  const auto halts = [&](HaltsInstead::Why why, const std::string& lens_says = {}) {
    if (request.moving) observer.warned(HaltsInstead{why, lens_says});
    return false;
  };
  if (!request.moving.value_or(rig.camera().streams())) return false;
  if (!rig.lens().can_be_watched())
    return halts(HaltsInstead::Why::unwatched, rig.lens().why_unwatched());
  if (!limits.blur) return halts(HaltsInstead::Why::not_by_spectra);
  // Frames that come by themselves cost nothing on the way: no halt, and they tell sooner on which
  // side the focus is. Where each must be asked for, a halt for few of them is cheaper than many.
  // Where they turn out to be too few or too smeared, halts follow.
  return !request.frames && rig.camera().is_live() && rig.options().shot.average == 1;
}

}  // namespace fathom
