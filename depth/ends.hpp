// SPDX-License-Identifier: Apache-2.0
// Whether a focus lies within what was swept: its detail, without any law, stands above that at both
// ends. To the law alone a focus beyond the frames looks like one within.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace fathom::depth {

class Ends {
 public:
  /// positions: of the frames, at least one, in any order and unit. near: what lies nearer to a place
  /// than this tells of it, where the end is far enough.
  Ends(std::span<const double> positions, double near);

  /// detail: of each frame, more where it is sharper, by any zero. Whether it is greater near a
  /// place than near both ends, by a good part of what it is there above the mean of all frames.
  bool lie_below(std::span<const float> detail, double place) const;

  /// Whether they hold the focus between them: the same where detail is greatest.
  bool hold(std::span<const float> detail) const;

 private:
  double mean_near(std::span<const float> detail, double place, double near) const;

  std::vector<double> positions_;
  double low_, high_, near_;
};

}  // namespace fathom::depth
