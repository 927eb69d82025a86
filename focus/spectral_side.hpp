// SPDX-License-Identifier: Apache-2.0
// On which side of the pictures seen so far the focus is: the coarsest rings tell it from anywhere.
#pragma once

#include <span>
#include <vector>

#include "spectral.hpp"

namespace fathom {

// Lengths of the way, as blur that they add, px: what matters is what changes in a picture.
inline constexpr double kHopPx = 5;      ///< The first hop: enough for the side, little to go back.
inline constexpr double kStridePx = 10;  ///< Later ones: no focus hides between two pictures.
inline constexpr double kWingPx =
    1.9;  ///< The peak is passed from so far before it to so far behind.
inline constexpr double kFloorPx = 4.5;   ///< A picture so far away shows what no focus is.
inline constexpr double kFittedPx = 3;    ///< So far apart pictures on the way are fitted.
inline constexpr double kCloserPx = 0.6;  ///< Two pictures nearer than this tell the same.

/// Two evaluations, in the order of positions.
struct Neighbours {
  const Evaluation* low = nullptr;
  const Evaluation* high = nullptr;
};

/// The one whose coarsest rings are strongest, and the one nearest to it. evaluations: two at least,
/// with rings of this side; no position twice.
Neighbours around_sharpest(std::span<const Evaluation> evaluations, int side);

/// Which way pictures become sharper from those two on: +1 up, -1 down, 0 where noise hides it.
int sharper_side(std::span<const Evaluation> evaluations, int side);

/// Whether any picture is less sharp than the sharpest, beyond noise.
bool changes(std::span<const Evaluation> evaluations, int side);

/// Those within this distance of a place.
std::vector<Evaluation> near(std::span<const Evaluation> evaluations, double place,
                             double distance);

/// Whether two sure fits mean one focus, by their sigmas.
bool is_same_place(const SpectralFit& before, const SpectralFit& now, const BlurModel& model);

/// Whether the coarsest rings of the outermost pictures differ no more than such a focus lets them.
bool is_possible(std::span<const Evaluation> evaluations, double focus, const BlurModel& model);

/// The same, of the pictures near enough for the law of the widest window to hold.
bool is_possible_near(std::span<const Evaluation> evaluations, double focus,
                      const BlurModel& model);

}  // namespace fathom
