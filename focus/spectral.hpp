// SPDX-License-Identifier: Apache-2.0
// Where the focus is, from the ring powers of a few pictures: the law of defocus fitted to all
// rings of all pictures at once (docs/spectral.md).
//
// Power in ring k at lens position z, focus p:  P_k(z) = A_k M_k(z - p)^2 + n(z).  The object's
// powers A_k are the same in every picture; the noise n is white, and each picture's own. Light
// that changes is taken out beforehand.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "blur.hpp"
#include "curve.hpp"

namespace fathom {

/// Where a fit says the focus is. Positions in the lens's unit.
struct SpectralFit {
  int side = 0;      ///< Of the window that it is of, px; 0 where there was nothing to fit.
  int pictures = 0;  ///< How many were fitted.
  double position = 0;
  double sigma = 0;  ///< Standard uncertainty, with what the blur model does not know.
  /// How much likelier the pictures are under the law than if nothing changed with the lens:
  /// natural logarithm of the ratio of likelihoods, over misfit where that is above 1.
  double evidence = 0;
  /// Chi-squared over degrees of freedom; far above 1: the pictures do not defocus as the model says.
  double misfit = 0;
  double second_position = 0;  ///< The next best place, apart from the best one;
  double second_worse = 0;  ///< by so much less likely, as `evidence`. Boundless if there is none.

  bool operator==(const SpectralFit&) const = default;
};

/// A fit with less evidence may be chance; one with more misfit is of pictures that do not defocus so.
inline constexpr double kLeastEvidence = 12, kWorstMisfit = 1.6;

/// Between which positions a focus is looked for.
struct SpectralRange {
  double low = 0;
  double high = 0;
};

/// The fit of those evaluations that have rings of this side; two at least, at two positions, or
/// nothing is fitted. Throws as require_valid.
SpectralFit fit_spectra(std::span<const Evaluation> evaluations, int side, const BlurModel& model,
                        const SpectralRange& range);

/// The largest side of which every evaluation has rings, and the smallest; 0 if there is none.
struct RingSides {
  int smallest = 0;
  int largest = 0;
};
RingSides ring_sides(std::span<const Evaluation> evaluations);

/// How the coarsest rings change from one picture to another: blur that is far beyond a window
/// still takes from them.
struct CoarseChange {
  double part = 0;   ///< ln of the second power over the first.
  double sigma = 0;  ///< What noise makes of that.
};
CoarseChange coarse_change(const Evaluation& first, const Evaluation& second, int side);

/// The largest such change that the law allows between pictures at these distances from a focus: that
/// of the finest of those rings.
double most_coarse_change(double first_from_focus, double second_from_focus, int side,
                          const BlurModel& model);

}  // namespace fathom
