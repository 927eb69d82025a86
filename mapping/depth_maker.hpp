// SPDX-License-Identifier: Apache-2.0
// Makes depth maps and the all-in-focus picture of frames that come one by one.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "depth/align.hpp"
#include "depth/mapper.hpp"
#include "depth/stack_light.hpp"
#include "hal/drivers/replay/stack.hpp"
#include "mapping/depth_result.hpp"
#include "pictures/picture.hpp"

namespace fathom::mapping {

/// A frame with its colours, if it has some, and where the first frame lies in it.
struct ColourPicture {
  Frame grey;
  Colours colours;
  Similarity place = {};
};

/// Scores each frame and blends it in, on two threads, and lets go of it.
class DepthMaker {
 public:
  /// positions: of the frames that will come. Throws as DepthMapper and SharpPicture.
  DepthMaker(const OpenDevice& open, const PictureShape& shape, bool has_colours,
             std::vector<double> positions, const DepthOptions& options);

  /// A picture at positions[frame]. Throws as DepthMapper::add and SharpPicture::add.
  void add(std::size_t frame, const ColourPicture& picture);
  /// Several pictures of one position, of which `mean` is the mean of the greys.
  void add_mean(std::size_t frame, const Frame& mean, const Similarity& place);
  void blend(std::size_t frame, const ColourPicture& picture);

  /// How far the last frame lies from the first one at the picture's corners, px.
  double moved_px() const { return moved_px_; }
  /// The energy of detail of what was added, in a coarse grid of places.
  const CurveGrid& curves() const { return curves_; }
  /// How many frames were added.
  std::size_t added() const { return seen_.size(); }

  /// Maps and picture of what was added; unit and rig are left to the caller. Nothing can be added
  /// afterwards. is_filled: whether holes are closed. Throws as DepthMapper::finish.
  DepthResult finish(bool is_filled);

 private:
  void map(std::size_t frame, const Frame& grey, const Seen& seen);
  void blend(std::size_t frame, const ColourPicture& picture, double gain);

  std::vector<double> positions_;
  DepthMapper mapper_;
  SharpPicture sharp_;
  StackLight light_;
  CurveGrid curves_;
  std::vector<Seen> seen_;
  std::vector<double> seen_at_;
  double moved_px_ = 0;
};

/// How many frames are done, of all. Returning false ends the reading.
using FramesDone = std::function<bool(std::size_t done, std::size_t total)>;

/// Reads every picture of a recording, the next one while this one is computed, until `done` says
/// that it is enough. Throws Error(bad_data) for grey pictures among those in colour, and as
/// RecordedStack::read and DepthMaker::add.
void read_stack(replay::RecordedStack& stack, StackAligner& aligner, DepthMaker& maker,
                const FramesDone& done);

}  // namespace fathom::mapping
