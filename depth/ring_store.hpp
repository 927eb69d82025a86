// SPDX-License-Identifier: Apache-2.0
// Ring powers of many windows in many frames, a byte each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fathom::depth {

/// Powers as floats of 5 bits of exponent and 3 of fraction: exact to 2.5 % (root mean square), from
/// 2^-22 to 2^9 of a unit. What is below counts as 0.
class RingStore {
 public:
  RingStore(std::size_t values, std::size_t frames) : values_(values), frames_(frames) {}

  bool has(std::size_t frame) const { return !frames_[frame].empty(); }

  /// Powers in units, from value number `first` on. The frame's others are 0 until they are put.
  void put(std::size_t frame, std::size_t first, std::span<const double> powers, double unit);
  /// Says that nothing is known of these.
  void forget(std::size_t frame, std::size_t first, std::size_t count);
  /// Powers of a frame that there is; NaN for what was forgotten.
  void take(std::size_t frame, std::size_t first, std::span<float> powers) const;

 private:
  std::size_t values_;
  std::vector<std::vector<std::uint8_t>> frames_;
};

}  // namespace fathom::depth
