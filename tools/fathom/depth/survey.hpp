// SPDX-License-Identifier: Apache-2.0
// The surfaces that a rig sees: a stack is taken, mapped and taken apart.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration.hpp"
#include "depth/surfaces.hpp"
#include "session/kept_surface.hpp"
#include "tools/fathom/depth/sharper_end.hpp"
#include "tools/fathom/depth/taking.hpp"

namespace fathom::cli {

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

/// Takes what `taking` has and finds its surfaces. label: of the progress bar; blur: of the lens,
/// where the lens does not say it; observer: of a live sweep. Throws as Taking::take and
/// DepthMaker::finish.
Survey survey(Taking& taking, const std::string& label, const OpenDevice& open,
              const std::optional<BlurModel>& blur, Observer& observer);

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

}  // namespace fathom::cli
