// SPDX-License-Identifier: Apache-2.0
// How well a focus quality value repeats (thesis p. 58).
#pragma once

#include "tools/fathom/reproduce/curves.hpp"

namespace fathom::reproduce {

/// Readings of the chart at one lens position.
struct Readings {
  double distance_mm = 0;
  bool far = false;  ///< kReadingsFar steps from focus instead of in focus.
  int average = 1;   ///< Frames a reading.
  std::vector<ThreeNumbers> scores;

  Summary of(std::size_t transform) const;
};

inline constexpr double kReadingsFar = 300;
inline constexpr int kManyFrames = 10;  ///< "snap ten frames and average them".

struct Repeatability {
  std::vector<Readings> readings;

  /// Throws std::out_of_range for what was not measured.
  const Readings& find(double distance_mm, bool far, int average) const;
  /// Over the three distances, in focus: the largest half range as a part of the mean.
  double worst_half_range(std::size_t transform, int average) const;
};

void plan_repeatability(Repeatability& repeatability, const Effort& effort,
                        const ShouldStop& should_stop, Tasks& tasks);

}  // namespace fathom::reproduce
