// SPDX-License-Identifier: Apache-2.0
// From what a kernel leaves of a window to the numbers of its metric.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/metric.hpp"

namespace fathom::gpu {

class Results {
 public:
  explicit Results(const MetricSpec& spec);

  /// 32-bit words of one window in the storage buffer FATHOM_SCORES. A moment SUM m r^2 is an
  /// integer of 64 bits, low word first, or a sum of two floats; the sum of each ring is such an
  /// integer or one float.
  std::size_t words() const { return words_; }

  /// words: of one window; values: spec.outputs().
  void read(const std::uint32_t* words, std::span<double> values) const;

 private:
  MetricSpec spec_;
  std::size_t words_;
  double sum_scale_;
  std::vector<double> ring_divisors_;  ///< A ring's sum over its mean mass; whole numbers.
};

}  // namespace fathom::gpu
