// SPDX-License-Identifier: Apache-2.0
// What fathom_gpu_throughput and the CUDA peer have in common, so that both are timed at the same
// work. Nothing but the standard library: nvcc compiles it on a machine without Fathom's sources.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace fathom::bench {

/// The largest frame. A batch whose windows would make a larger one has fewer windows.
constexpr std::size_t kMostFrameBytes = std::size_t{1} << 30;

/// What there is beside the largest frame for the next ones to differ: more than the second-level
/// cache of any card so far (50 MB on an H100).
constexpr std::size_t kSpareBytes = std::size_t{256} << 20;

/// Those that have bars come first, in case there is no time for all.
inline std::vector<int> all_sides() { return {64, 8, 16, 32, 128, 256, 512}; }
inline std::vector<std::size_t> all_batches() { return {100000, 4096, 64, 1}; }

/// splitmix64 (Steele, Lea, Flood 2014): eight random bytes in a nanosecond.
inline std::uint64_t random_word(std::uint64_t number) {
  std::uint64_t z = (number + 1989) * 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31);
}

/// Rows of the squarest frame that exactly so many windows tile.
inline std::size_t tile_rows(std::size_t windows) {
  std::size_t rows = 1;
  for (std::size_t divisor = 1; divisor * divisor <= windows; ++divisor) {
    if (windows % divisor == 0) rows = divisor;
  }
  return rows;
}

/// Where frame number 0, 1, 2, .. begins in a row of `all` random bytes: they repeat after some,
/// but never the next one.
inline std::size_t frame_offset(std::size_t number, std::size_t frame_bytes, std::size_t all) {
  const std::size_t spare = all - frame_bytes;
  const std::size_t step = std::min((frame_bytes + 63) / 64 * 64, spare / 4 / 64 * 64);
  return number % (spare / step) * step;
}

/// Seconds a step, over repetitions.
struct Times {
  double min_s = 0;
  double median_s = 0;
  double max_s = 0;
  std::size_t repetitions = 0;
};

inline double seconds() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

/// Steps until budget_s have passed, and at least five repetitions; as many steps are one
/// repetition as take a ninth of the budget. A step waits for the batch before the last and starts
/// another: what is measured is the steady state, without the first and the last batch.
template <class Step>
Times time_steps(const Step& step, double budget_s) {
  const double start = seconds();
  double now = start;
  std::size_t warm = 0;  // also fills the pipeline, and wakes the card's clocks
  while (warm < 3 || now - start < budget_s / 4) {
    step();
    ++warm;
    now = seconds();
  }
  const double wanted = budget_s / 9 * static_cast<double>(warm) / (now - start);
  const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(wanted)));
  std::vector<double> times;
  const double end = now + budget_s;
  while (times.size() < 5 || now < end) {
    for (std::size_t i = 0; i < steps; ++i) step();
    const double then = std::exchange(now, seconds());
    times.push_back((now - then) / static_cast<double>(steps));
  }
  std::sort(times.begin(), times.end());
  return {times.front(), times[times.size() / 2], times.back(), times.size()};
}

}  // namespace fathom::bench
