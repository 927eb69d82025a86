// SPDX-License-Identifier: Apache-2.0
// How bright the pictures of a stack are: lamps flicker, exposures drift.
#pragma once

#include <cstdint>
#include <vector>

#include "../engine/frame.hpp"
#include "similarity.hpp"

namespace fathom {

/// Levels every picture of a stack to the first one. Blur moves light, but keeps its sum: so sums of
/// the same places are compared, in many parts of the picture, and parts that disagree (something
/// moved) count less (Huber 1964). Places where either picture is clipped are left out, unless most
/// are.
class StackLight {
 public:
  /// What the greys of this picture are multiplied by to be as bright as those of the first one: 1
  /// for that one, and where nothing can be compared. place: where the first one lies in it. Throws
  /// Error(bad_argument) for a picture of another size.
  double add(const Frame& grey, const Similarity& place = {});

 private:
  /// The picture in square cells.
  struct Cells {
    int columns = 0, rows = 0;
    std::vector<float> means;
    std::vector<bool> is_clipped;  ///< Whether one of its pixels is.
  };
  Cells cells_of(const Frame& grey) const;
  void note_clipped(const Frame& grey, const std::vector<std::uint32_t>& brightest,
                    Cells& cells) const;
  double gain_of(const Cells& cells, const Similarity& place) const;

  int width_px_ = 0, height_px_ = 0;
  int side_px_ = 0;  ///< Of a cell.
  Cells first_;
};

}  // namespace fathom
