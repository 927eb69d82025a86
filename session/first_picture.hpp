// SPDX-License-Identifier: Apache-2.0
// A picture of where a lens stood before a search, held beside the sharp one that it found
// (focus/first_look.hpp).
#pragma once

#include <optional>
#include <span>

#include "../engine/frame.hpp"
#include "../engine/window.hpp"
#include "../focus/curve.hpp"
#include "../focus/first_look.hpp"

namespace fathom {

/// A part of a frame. It must lie inside.
struct Area {
  int x, y, width, height;
};
Patch patch_of(const Frame& frame, const Area& area);

struct PictureAt {
  double position = 0;  ///< Of the lens, in its unit.
  Frame frame;
};

/// What is known of the lens's blur.
struct BlurKnown {
  BlurModel model;
  bool is_by_optics = false;  ///< Its optics tell it, so that it is hardly off.
};

/// What is compared.
struct FirstPictures {
  const PictureAt& sharp;  ///< Of a search that found a focus,
  const PictureAt& first;  ///< from before it,
  const PictureAt*
      beside;  ///< and of a place near to that one, taken later; null where there is none.
};

/// Compares the picture of a place with the sharp one of a search that found this focus. Where they
/// contradict each other, and somebody only said how the lens blurs, what was evaluated is asked for
/// that as well. Nothing where too little blur is foretold, or so much that the picture does not hold
/// it.
std::optional<FirstLook> look_at_first_picture(const FirstPictures& pictures, const Window& window,
                                               double focus, const BlurKnown& known,
                                               std::span<const Evaluation> evaluations);

}  // namespace fathom
