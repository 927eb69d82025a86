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
  int way_runs = 20;       ///< Of each way to a distance.
  int noise_runs = 10;     ///< At each level of noise, of two ways.

  static Effort full() { return {}; }
  /// Enough to see that everything works.
  static Effort short_one() {
    return {.quick = true,
            .curve_step = 40,
            .far_seeds = 1,
            .readings = 6,
            .per_distance = 2,
            .own_distances = 2,
            .plants = 1,
            .random_runs = 4,
            .blank_runs = 2,
            .orange_runs = 1,
            .side_runs = 1,
            .search_runs = 2,
            .way_runs = 2,
            .noise_runs = 1};
  }
};

}  // namespace fathom::reproduce
