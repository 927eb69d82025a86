// SPDX-License-Identifier: Apache-2.0
// Frames in, their ring powers at all levels out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "depth/levels.hpp"
#include "depth/ring_store.hpp"
#include "engine/scorer.hpp"

namespace fathom::depth {

/// Powers are told for a brightness that all frames are levelled to: that of the first one.
class Scoring {
 public:
  /// Throws as `open` and Scorer.
  Scoring(const OpenDevice& open, std::vector<Level> levels, std::size_t frames);

  /// threads: for what the device does not do. Throws as Scorer::score.
  void add(std::size_t frame, const Frame& grey, const Seen& seen, int threads);

  const std::vector<Level>& levels() const { return levels_; }
  const RingStore& rings(std::size_t level) const { return stores_[level]; }
  /// Processors that the device keeps busy.
  int device_threads() const;
  /// Frees everything: there is nothing any more, and nothing can be added.
  void clear();

  /// Internals, in scoring.cpp.
  struct Around;

 private:
  void add_level(std::size_t level, std::size_t frame, const Frame& picture, const Seen& seen);
  /// A frame that lies as the reference does.
  void add_grid(std::size_t level, std::size_t frame, const Frame& picture, double unit);
  /// Powers of these nodes, at the beginning of values_.
  void score(std::size_t level, const Frame& picture, std::span<const Around> nodes);

  std::vector<Level> levels_;
  std::vector<RingStore> stores_;
  std::vector<std::unique_ptr<Scorer>> scorers_;
  std::vector<std::vector<std::uint16_t>> halved_;  ///< Pixels of the halved pictures.
  std::vector<double> values_;                      ///< Of one call.
  double first_square_ = 0;  ///< Mean square of the first frame's pixels: the unit of power.
  double fineness_ = 1;      ///< Levels of the halved pictures for each grey level of the frame.
};

}  // namespace fathom::depth
