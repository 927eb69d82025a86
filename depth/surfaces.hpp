// SPDX-License-Identifier: Apache-2.0
// The surfaces that a map of depth shows: its connected parts, each with its place and how sure that
// is.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "../engine/frame.hpp"
#include "../engine/window.hpp"
#include "maps.hpp"

namespace fathom {

/// A rectangle of pixels, half-open as a Window.
struct PixelBox {
  int x = 0;
  int y = 0;
  int width_px = 0;
  int height_px = 0;
};

/// A connected part of a map, or several that one plane holds. Positions in the map's unit.
struct SeenSurface {
  std::size_t area_px = 0;  ///< Its pixels whose depth was measured.
  PixelBox box = {};
  double centre_x = 0;  ///< Mean place of its pixels, px.
  double centre_y = 0;
  double position = 0;  ///< Mean over its area, without the rim, where windows see beyond it.
  double sigma = 0;     ///< Of that mean: noise, and what all places share.
  double spread = 0;    ///< Root mean square of its positions about the mean.
  double relief = 0;    ///< The same without what noise explains: how it leans and bends.
  double slope_x = 0;   ///< Of the plane that fits it best, for each pixel to the right, and down.
  double slope_y = 0;
  double texture = 0;  ///< Its part of the picture's squared differences, 0 to 1; 0 without one.
  int pieces = 1;      ///< Parts of it that lie apart, with no texture in between.
};

/// The surfaces of a map of depth, and which place belongs to which.
struct Surfaces {
  std::vector<SeenSurface> found = {};  ///< The largest first.
  std::size_t small = 0;                ///< Parts that were too small to be told.
  /// Which of `found` each cell belongs to, row by row; kNone where none. Cells are squares of
  /// side_px; those at the right and the lower edge may be cut off.
  std::vector<int> owner = {};
  int side_px = 0;
  int columns = 0;
  int rows = 0;
  int width_px = 0;                  ///< Of the picture.
  int height_px = 0;                 ///< Of the picture.
  std::vector<float> texture = {};   ///< Of each cell.
  std::vector<float> position = {};  ///< Of each cell; NaN where it is not known.
  double usual_sigma = 0;            ///< Of one place, the median.

  static constexpr int kNone = -1;
};

/// Neighbouring places belong together where they agree within their sigmas and the slopes around
/// them. They do not across a jump that noise and those slopes do not explain, nor across two depths
/// or a bridge that is only one or two cells wide. Across places without texture they do where one
/// plane holds both sides. What was filled does not count. Linear in pixels, nearly. sharp: the all-in-focus picture, or null. Throws Error(bad_argument) for a picture of
/// another size than the map's.
///
/// Places have noise of their own only beyond the reach of the map from each other, so the area counts
/// as so many squares of it. The mean is never surer than the law of blur (shared_sigma).
Surfaces find_surfaces(const DepthMaps& maps, const Frame* sharp = nullptr);

/// The window of side n with the most texture of one depth, within one of the surfaces: of number
/// `surface`, or of any where that is absent. Nothing where none has room for it: nine tenths of a
/// window must be known, and nothing of it another surface.
struct AimedWindow {
  Window window;
  int surface = 0;  ///< Number in `found`.
};
std::optional<AimedWindow> richest_window(const Surfaces& surfaces, int n,
                                          std::optional<int> surface = std::nullopt);

}  // namespace fathom
