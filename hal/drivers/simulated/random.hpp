// SPDX-License-Identifier: Apache-2.0
// Random numbers that are the same on every machine: std::normal_distribution is not.
#pragma once

#include <cstdint>

namespace fathom::simulated {

/// One round of splitmix64 (Steele, Lea, Flood 2014): spreads a counter or a seed over 64 bits.
constexpr std::uint64_t mix(std::uint64_t value) {
  value += 0x9e3779b97f4a7c15u;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
  return value ^ (value >> 31);
}

/// What a stream of numbers is for, so that one seed serves all and none disturbs another.
enum class Stream : std::uint64_t { scene = 1, fixed_pattern, drift, frame_noise, motor };

/// A splitmix64 generator: 64 bits of state, no bad seeds, and quick enough for a number per pixel.
class Random {
 public:
  /// index: which of many streams of a kind, e.g. the number of a frame.
  Random(std::uint64_t seed, Stream stream, std::uint64_t index = 0)
      : state_(mix(mix(mix(seed) + static_cast<std::uint64_t>(stream)) + index)) {}

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Normal, mean 0 and deviation 1.
  double gaussian();

 private:
  std::uint64_t next() {
    const std::uint64_t value = mix(state_);
    state_ += 0x9e3779b97f4a7c15u;
    return value;
  }

  std::uint64_t state_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace fathom::simulated
