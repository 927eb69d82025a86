// SPDX-License-Identifier: Apache-2.0
// One search or one sweep on a rig: what was asked, what was measured, what it came to.
#pragma once

#include <optional>
#include <vector>

#include "../focus/focus.hpp"
#include "measurement.hpp"

namespace fathom {

struct Run {
  std::optional<double> target_mm;    ///< Known distance of the target, if any.
  std::optional<FocusLimits> limits;  ///< Absent for a sweep, which only evaluates.
  double repeat_scatter = 0;
  bool tracks = false;  ///< Began where the run before it ended (focus/track.hpp).
  std::vector<Measurement> measurements;  ///< In the order in which they were made.
  std::optional<Focus> focus;  ///< The answer; absent for a sweep or an unfinished search.

  std::vector<Evaluation> evaluations() const;
};

}  // namespace fathom
