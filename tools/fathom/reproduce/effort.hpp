// SPDX-License-Identifier: Apache-2.0
// How much is measured. Every number follows from these and from fixed seeds.
#pragma once

#include <cstdint>

namespace fathom::reproduce {

/// The rig of every experiment that does not ask for many.
inline constexpr std::uint64_t kSeed = 1989;

struct Effort {
  bool quick = false;
  int curve_step = 5;      ///< Steps between samples of the plotted curves.
  int far_seeds = 4;       ///< Rigs whose far floor is measured, at each distance and target.
  int readings = 40;       ///< Of a repeatability test.
  int per_distance = 0;    ///< Runs of a table's row; 0: as many as the thesis'.
  int own_distances = 30;  ///< Where Fathom's own way is tried, for each metric.
  int plants = 12;         ///< Seedlings, each another.
  int random_runs = 120;   ///< Of random targets, noise and seeds.
  int blank_runs = 40;     ///< The same without any texture.
  int orange_runs = 12;    ///< Of each window size and distance.
  int side_runs = 8;       ///< Of each window side.
  int search_runs = 24;    ///< Of each search that is compared.

  static Effort full() { return {}; }
  /// Enough to see that everything works.
  static Effort short_one() { return {true, 40, 1, 6, 2, 2, 1, 4, 2, 1, 1, 2}; }
};

}  // namespace fathom::reproduce
