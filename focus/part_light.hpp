// SPDX-License-Identifier: Apache-2.0
// Light that changes in a part of the picture: a lamp, a shadow or a reflection that moves. The light
// of the whole picture, which a curve is corrected by, tells nothing of it.
#pragma once

#include <vector>

#include "curve.hpp"
#include "noise.hpp"

namespace fathom {

/// What the brightness of the window's parts says of a curve.
struct PartLight {
  /// Part of the peak's height that stays where each part is taken in one light of its own, 0..1; no
  /// more than kEdge where the edge of a light or a shadow in the window may have made the peak.
  /// 1 from 0.6 on: blur, and a camera that shifts a little, change how bright a part is, too.
  double left = 1;
  bool explains_all = false;  ///< Nothing stands out in a light of each part's own.

  static constexpr double kEdge = 0.5;
};

/// evaluations: in any order, with the scores and the brightness of their parts; where those are not
/// known, or no peak of theirs stands out, all of it stays.
PartLight part_light_of(const std::vector<Evaluation>& evaluations, const Scatter& part_scatter);

}  // namespace fathom
