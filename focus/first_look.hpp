// SPDX-License-Identifier: Apache-2.0
// Whether a picture from before a search is as blurred as its place foretells: steps that a motor lost
// under way, and a target that moved meanwhile, show there at no travel.
#pragma once

#include <optional>

#include "blur.hpp"
#include "resemblance.hpp"

namespace fathom {

struct Focus;

/// A picture of long ago beside the sharp one, blurred until both are alike.
struct FirstLook {
  double foretold_px = 0;  ///< Blur that its place should have by the focus that was found,
  double seen_px = 0;      ///< and that with which the sharp picture is most like it.
  double unexplained = 1;  ///< What that leaves of the picture's variance, 0..1.
  /// How much likelier that blur is than any that the law allows, for white noise: chi^2 of one
  /// degree of freedom.
  double evidence = 0;
  /// The same against what a picture beside it allows, where relief or shading mislead the law; 0
  /// where there was none.
  double evidence_beside = 0;

  bool operator==(const FirstLook&) const = default;
};

/// What the pictures are of.
struct FirstLookPlan {
  BlurShape shape = BlurShape::disc;
  double foretold_px = 0;                          ///< Diameter of the blur of the first picture,
  double doubt_px = 0;                             ///< how far that may be off by the law alone,
  std::optional<double> beside_px = std::nullopt;  ///< and by what another picture shows,
  double sharp_px = 0;                             ///< and of the blur that the sharp picture has.
  bool is_exact = false;  ///< Whether seen_px is wanted exactly even where it is as foretold.
  int margin_px = 0;      ///< By how much `sharp` reaches beyond `first`, on each side.
};

/// The widest blur that is tried where so much is foretold, px: what a margin must hold half of.
double widest_tried(double foretold_px);

/// The side of a square that tells all that such a blur lets tell, px.
int telling_side(double foretold_px);

/// first: of the middle of `sharp`. Light that is brighter by a factor, or by a constant, does not
/// matter, nor a shift by a small part of the blur. Nothing where a picture is flat, or so little blur
/// is foretold that there is nothing to compare.
std::optional<FirstLook> look_at_first(const Patch& sharp, const Patch& first,
                                       const FirstLookPlan& plan);

/// Whether it is so far from what the law allows that another picture must be heard.
bool is_striking(const FirstLook& look);

/// Whether the first picture says clearly that it is of another place.
bool contradicts(const FirstLook& look);

/// Takes it into account: a focus that the first picture contradicts is none (Why::changed).
void doubt_for_first_look(Focus& focus, const std::optional<FirstLook>& look,
                          double first_position);

}  // namespace fathom
