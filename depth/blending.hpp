// SPDX-License-Identifier: Apache-2.0
// How much of the all-in-focus picture each frame gets, and how it gets there.
#pragma once

#include <cstdint>

#include "../engine/frame.hpp"
#include "plane.hpp"
#include "similarity.hpp"

namespace fathom::depth {

/// How much of a new frame each cell takes, 0 to 1, by the energy of its detail; its weight is added
/// to those before it.
Plane shares_of(const Plane& energy, Plane& weights);

/// Energy that one finds far around counts too, but less: what is faint beside an edge goes with
/// the edge, not with its glow in a frame that is out of focus there.
Plane with_surroundings(const Plane& energy);

/// What is clipped in a frame that is brighter than others hides what they show: cells with a clipped
/// pixel keep a tenth of their energy.
void doubt_clipped(const Frame& grey, Plane& energy);

/// 1 for cells of a picture of this size that the frame there shows whole, with some pixels round
/// them; 0 for the others.
Plane shown_by(const Similarity& place, int width_px, int height_px);

/// stored += share (value - stored), `width` numbers each. Whole numbers are rounded.
void blend_row(const float* share, const float* value, float* stored, int width);
void blend_row(const float* share, const float* value, std::int16_t* stored, int width);

}  // namespace fathom::depth
