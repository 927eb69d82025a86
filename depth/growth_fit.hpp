// SPDX-License-Identifier: Apache-2.0
// One number for how a picture grows over a stack, from what its pairs of frames tell.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "align.hpp"

namespace fathom::depth {

class GrowthFit {
 public:
  explicit GrowthFit(GrowthLaw law) : law_(std::move(law)), per_unit_(law_.per_unit) {}

  double per_unit() const { return per_unit_; }
  /// Of a frame over the first one, by what is known now.
  double scale(std::size_t frame) const { return 1 + per_unit_ * from_first(frame); }
  /// Of a frame over the one before it.
  double ratio(std::size_t frame) const { return scale(frame) / scale(frame - 1); }

  /// What was measured of ratio(frame). The number is fitted again to all that was: least squares
  /// with the law's own, in which what lies far off counts less (Huber 1964).
  void add(std::size_t frame, double ratio, double sigma);

 private:
  struct Pair {
    std::size_t frame;
    double ratio, sigma;
  };
  double from_first(std::size_t frame) const {
    return law_.positions.at(frame) - law_.positions.front();
  }
  void fit();

  GrowthLaw law_;
  double per_unit_;
  std::vector<Pair> pairs_;
};

}  // namespace fathom::depth
