// SPDX-License-Identifier: Apache-2.0
// The all-in-focus picture of a stack, made in one pass: frames are blended as they come and
// dropped.
//
// Each frame is taken apart into details (periods below 8 px, 8 to 32 px, ...) and a rest. Every
// part of the result is the mean of the frames' parts, weighed by a power of the energy of detail
// there. So where one frame is sharp, it alone counts; where none is, all do, and their noise goes.
// The energies are smoothed, coarser parts over more pixels, so that no seam can be. (Burt and
// Adelson 1983 blend pyramids; Burt and Kolczynski 1993 weigh them by local energy.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "../engine/colours.hpp"
#include "../engine/frame.hpp"
#include "similarity.hpp"

namespace fathom {

/// What a stack comes to.
struct Sharp {
  Frame grey;  ///< The luma of the colours, where there are some.
  Colours colours;
  /// Of every pixel, row by row, the frame whose detail is strongest there.
  std::vector<std::uint16_t> frame;
};

/// Memory: 2 bytes a pixel and channel of 8 bits, 4 of 16, and about 2 more; beside them, while a
/// frame is added, some rows and a sixteenth of it in floats.
class SharpPicture {
 public:
  /// has_colours: whether frames come with colours. Throws Error(bad_argument) for a side that is
  /// not positive.
  SharpPicture(int width_px, int height_px, Depth depth, bool has_colours);
  ~SharpPicture();
  SharpPicture(SharpPicture&&) noexcept;
  SharpPicture& operator=(SharpPicture&&) noexcept;

  /// Blends a frame in. place: where the result's pixels lie in it. gain: what it is multiplied by to
  /// be as bright as the result (StackLight). Throws Error(bad_argument) for a frame of another size
  /// or depth, or colours that are missing or not its own.
  void add(std::size_t frame, const Frame& grey, const Colours& colours,
           const Similarity& place = {}, double gain = 1);

  /// The mean energy of detail of the frame that was added last, in columns x rows equal parts of
  /// the picture, row by row: a focus curve, frame by frame.
  std::vector<float> energies(int columns, int rows) const;

  /// The picture; frees what was stored: nothing can be added afterwards. Throws
  /// Error(bad_argument) where no frame was added.
  Sharp finish();

  /// Internals, in sharp.cpp.
  class Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace fathom
