// SPDX-License-Identifier: Apache-2.0
// What one thread of this processor can do at most: the roof of the roofline. Compiled for the
// processor that it runs on.
//
//   ceiling/copy    bytes read and written a second, in memory larger than any cache
//   ceiling/read    bytes read a second from the first-level cache
//   ceiling/flops   floating point operations a second, fused multiply-adds counted as two
#include <benchmark/benchmark.h>

#include <cstring>
#include <vector>

namespace fathom::bench {
namespace {

using benchmark::Counter;

void copy(benchmark::State& state) {
  constexpr std::size_t kBytes = std::size_t{256} << 20;
  std::vector<char> from(kBytes, 1), to(kBytes, 2);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), kBytes);
    benchmark::ClobberMemory();
  }
  state.counters["per_s"] =
      Counter(2.0 * kBytes * static_cast<double>(state.iterations()), Counter::kIsRate);
}

#if defined(__AVX512F__)
constexpr std::size_t kVectorBytes = 64;
#elif defined(__AVX__)
constexpr std::size_t kVectorBytes = 32;
#else
constexpr std::size_t kVectorBytes = 16;
#endif
typedef float Vector __attribute__((vector_size(kVectorBytes)));
constexpr std::size_t kLanes = kVectorBytes / sizeof(float);

/// Twelve sums at once, so that no unit waits for another's result.
void flops(benchmark::State& state) {
  constexpr int kSums = 12, kTurns = 4096;
  Vector sums[kSums] = {}, factor = {}, addend = {};
  for (std::size_t i = 0; i < kLanes; ++i) {
    factor[i] = 0.999F;
    addend[i] = 0.001F;
  }
  benchmark::DoNotOptimize(factor);
  benchmark::DoNotOptimize(addend);
  for (auto _ : state) {
    for (int turn = 0; turn < kTurns; ++turn) {
#pragma GCC unroll 12
      for (Vector& sum : sums) sum = sum * factor + addend;
    }
    for (Vector& sum : sums) benchmark::DoNotOptimize(sum);
  }
  state.counters["per_s"] = Counter(
      2.0 * kLanes * kSums * kTurns * static_cast<double>(state.iterations()), Counter::kIsRate);
}

void read(benchmark::State& state) {
  constexpr std::size_t kBytes = 16384, kVectors = kBytes / kVectorBytes;
  alignas(64) static Vector numbers[kVectors];
  Vector sums[4] = {};
  for (auto _ : state) {
    benchmark::DoNotOptimize(numbers);
    for (std::size_t i = 0; i < kVectors; i += 4) {
#pragma GCC unroll 4
      for (std::size_t k = 0; k < 4; ++k) sums[k] += numbers[i + k];
    }
    for (Vector& sum : sums) benchmark::DoNotOptimize(sum);
  }
  state.counters["per_s"] = Counter(
      static_cast<double>(kBytes) * static_cast<double>(state.iterations()), Counter::kIsRate);
}

BENCHMARK(copy)->Name("ceiling/copy");
BENCHMARK(read)->Name("ceiling/read");
BENCHMARK(flops)->Name("ceiling/flops");

}  // namespace
}  // namespace fathom::bench
