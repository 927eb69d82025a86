// SPDX-License-Identifier: Apache-2.0
// The surfaces that a rig sees: a stack was taken and mapped, and its map is taken apart.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration.hpp"
#include "depth/surfaces.hpp"
#include "engine/travel.hpp"
#include "focus/focus.hpp"
#include "mapping/depth_result.hpp"
#include "mapping/sharper_end.hpp"
#include "session/kept_surface.hpp"

namespace fathom::mapping {

struct Survey {
  Surfaces surfaces;         ///< In the lens's unit.
  std::size_t left_out = 0;  ///< Parts of the map that the pictures' detail contradicts.
  std::optional<TravelEnd> sharper = {};  ///< Where a focus lies beyond the frames.
  std::size_t expected = 0;               ///< Frames that there would have been without a stop.
  std::string unit;
  std::vector<double> positions = {};  ///< Of the frames.
  std::vector<Seen> seen = {};         ///< How each of them was seen.
  double known = 0;                    ///< The part of the picture whose depth is known.
};

/// The step of a stack that is to show which surfaces there are: a quarter of what a coarse pass takes, so
/// that each focus is seen by some frames at either side; of a lens that says nothing, a part of the
/// travel.
double coarse_step(const LensInfo& lens, const FocusLimits& limits);

/// Its surfaces, without those that the pictures do not bear out. expected: frames that there would have
/// been without a stop.
Survey survey_of(const DepthResult& result, std::string unit, std::size_t expected);

/// A window of the first frame where its surface is sharpest: the frame that is nearest to that, of
/// pictures that move. As near as the picture's edge allows.
Window where_sharp(const Survey& survey, const AimedWindow& aimed);

/// As a run keeps it, without window and distance.
KeptSurface kept_of(const Surfaces& surfaces, const SeenSurface& surface);

/// A surface, and how far away it is.
struct RangedSurface {
  std::size_t number = 0;             ///< In Surfaces::found.
  std::optional<Distance> distance;   ///< As fathom::distance_of() has it.
  std::optional<AimedWindow> window;  ///< Where its texture is, to be measured by itself.
};

/// All surfaces. The nearest first with a calibration, else that with the largest position.
/// extrapolate: whether there are distances beyond the calibration.
std::vector<RangedSurface> ranged(const Surfaces& surfaces, const Calibration* calibration,
                                  bool extrapolate);

/// The largest window of at most `most` px that a surface has room for, and at least 16. surface: its
/// number; of any where that is absent.
std::optional<AimedWindow> roomiest_window(const Surfaces& surfaces, int most,
                                           std::optional<int> surface = std::nullopt);

}  // namespace fathom::mapping
