// SPDX-License-Identifier: Apache-2.0
// From a focal stack to a map of depth: frames are scored as they come and dropped.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "../engine/frame.hpp"
#include "../engine/selection.hpp"
#include "../focus/blur.hpp"
#include "maps.hpp"
#include "similarity.hpp"

namespace fathom {

/// Opens a device for a metric and so many windows a call, e.g. by select_device.
using OpenDevice = std::function<Selection(const MetricSpec& spec, std::size_t windows)>;

/// How a map is made; the defaults suit everybody.
struct DepthOptions {
  /// Sides of the windows, px, in any order; empty: several, weighed by what they tell.
  std::vector<int> sides = {};
  int stride = 0;  ///< Pixels between windows; 0: as dense as the number of frames allows.
  std::optional<BlurModel> blur =
      std::nullopt;  ///< Of the lens; fitted to the stack where it is not given.
};

/// One stack. Memory: at most 100 MB and 20 bytes a pixel, however many frames.
class DepthMapper {
 public:
  /// positions: of the frames, in the lens's unit, in any order. Throws Error(bad_argument) for
  /// fewer than 3 different positions, one that is not finite, a picture smaller than 32 px or a
  /// side that no window has, and what `open` throws.
  DepthMapper(const OpenDevice& open, int width_px, int height_px,
              std::span<const double> positions, const DepthOptions& options = {});
  ~DepthMapper();
  DepthMapper(DepthMapper&&) noexcept;
  DepthMapper& operator=(DepthMapper&&) noexcept;

  /// Scores one frame, in any order of frames; it is not kept. place: where the reference picture
  /// lies in it. gain: what makes it as bright as that, as StackLight tells it, which is asked where
  /// none is given. A frame that was added before is replaced. Throws Error(bad_argument) for a
  /// frame of another size, or an index beyond the positions, and as Scorer::score.
  void add(std::size_t frame, const Frame& grey, const Similarity& place = {},
           std::optional<double> gain = std::nullopt);

  /// The map of the frames that were added; those that were not do not count. Frees what was
  /// stored: nothing can be added afterwards. guide: the all-in-focus picture, or null. Throws
  /// Error(bad_argument) for a guide of another size.
  DepthMaps finish(const Frame* guide = nullptr);

  /// The blur that the map was made with, given or fitted: after finish().
  const BlurModel& blur() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Closes what is not known, and marks it `filled`, of confidence 0: at a cliff from the nearer side,
/// steps of the guide being far to cross where there is one, elsewhere smoothly from all around.
/// Sigma covers by how much positions differ that lie so far from each other; of what is `at_end`,
/// also the way to the farther end of what was swept. A map of which nothing is known stays as it
/// is. Throws Error(bad_argument) for a guide of another size.
void fill(DepthMaps& maps, const Frame* guide = nullptr);

}  // namespace fathom
