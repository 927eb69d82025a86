// SPDX-License-Identifier: Apache-2.0
// The loops that a map's time is spent in, compiled once per instruction set.
#pragma once

namespace fathom::depth {

/// The number of foci must be a multiple of this.
inline constexpr int kFociMultiple = 16;

/// Powers of one ring, less their mean, and the law that they are held against.
struct RingAndLaw {
  const float* powers = nullptr;  ///< [frame]
  const float* law = nullptr;     ///< [frame][focus]
  int frames = 0;
  int foci = 0;
};

/// sums[p] += weight c^2, c = max(SUM_z powers[z] law[z][p], 0).
void add_explained(const RingAndLaw& ring, float weight, float* sums);

/// sums[p] -= count log(1 - part c^2).
void add_likeness(const RingAndLaw& ring, float part, float count, float* sums);

}  // namespace fathom::depth
