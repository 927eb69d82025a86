// SPDX-License-Identifier: Apache-2.0
// How a lens blurs, learned from pictures that pass a focus: the law of defocus is fitted to their
// ring powers with the blur itself unknown (docs/spectral.md, "Where kappa comes from").
#pragma once

#include <optional>
#include <span>

#include "blur.hpp"
#include "curve.hpp"

namespace fathom {

/// A model that the pictures bear out.
struct BlurFit {
  BlurModel model;      ///< Its uncertainty is of this fit.
  double position = 0;  ///< Of the focus, fitted with it.
  double misfit = 0;    ///< As of a SpectralFit,
  double evidence = 0;  ///< likewise.
  double farthest = 0;  ///< Of the pictures that were fitted, from the focus.
  int pictures = 0;
};

/// What is asked of the pictures.
struct BlurFitOptions {
  std::optional<double>
      focus;       ///< Where it is, nearly, if that is known; else looked for among all.
  int a_side = 2;  ///< So many pictures must lie below the focus, and as many above.
};

/// Fits px_per_unit, rest_px and the likelier shape, together with the focus. Nothing where that
/// cannot be told: fewer than four pictures with rings, too few on one side, no change beyond noise,
/// or pictures that no such lens makes.
std::optional<BlurFit> fit_blur(std::span<const Evaluation> evaluations,
                                const BlurFitOptions& options = {});

/// Whether a lens that blurs at least twice, or at most half, as fast as this model says makes the
/// pictures likelier by more than chance. focus: where it is, nearly. A cheap look before fit_blur.
bool is_doubtful(std::span<const Evaluation> evaluations, const BlurModel& model, double focus);

/// Whether two models say the same, within half as much again and what either does not know.
bool agree(const BlurModel& a, const BlurModel& b);

}  // namespace fathom
