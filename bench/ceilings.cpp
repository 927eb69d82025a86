// SPDX-License-Identifier: Apache-2.0
// What one thread of this processor can do at most: the roof of the roofline. Compiled for the
// processor that it runs on.
//
//   ceiling/copy    bytes read and written a second, in memory larger than any cache
//   ceiling/read    bytes read a second from the first-level cache
//   ceiling/flops   floating point operations a second, fused multiply-adds counted as two
//
// ceiling/copy/threads:all and ceiling/flops/threads:all are those of all processors at once.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <thread>
#include <vector>

namespace fathom::bench {
namespace {

using benchmark::Counter;

/// work(k) for k = 0 .. threads - 1, all at once.
void on_threads(std::size_t threads, const std::function<void(std::size_t)>& work) {
  std::vector<std::jthread> others;
  for (std::size_t k = 1; k < threads; ++k) others.emplace_back(work, k);
  work(0);
}

void copy(benchmark::State& state, std::size_t threads) {
  constexpr std::size_t kBytes = std::size_t{256} << 20;
  std::vector<char> from(kBytes, 1), to(kBytes, 2);
  const std::size_t share = kBytes / threads;
  for (auto _ : state) {
    on_threads(threads,
               [&](std::size_t k) { std::memcpy(&to[k * share], &from[k * share], share); });
    benchmark::ClobberMemory();
  }
  const std::size_t copied = share * threads;
  state.counters["per_s"] =
      Counter(2.0 * static_cast<double>(copied * state.iterations()), Counter::kIsRate);
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
constexpr int kSums = 12;

void multiply_and_add(int turns) {
  Vector sums[kSums] = {}, factor = {}, addend = {};
  for (std::size_t i = 0; i < kLanes; ++i) {
    factor[i] = 0.999F;
    addend[i] = 0.001F;
  }
  benchmark::DoNotOptimize(factor);
  benchmark::DoNotOptimize(addend);
  for (int turn = 0; turn < turns; ++turn) {
#pragma GCC unroll 12
    for (Vector& sum : sums) sum = sum * factor + addend;
  }
  for (Vector& sum : sums) benchmark::DoNotOptimize(sum);
}

void flops(benchmark::State& state, std::size_t threads) {
  constexpr int kTurns = 1 << 21;  // some milliseconds, beside which a thread's start is little
  for (auto _ : state) on_threads(threads, [](std::size_t) { multiply_and_add(kTurns); });
  const auto turns = static_cast<double>(kTurns * threads * state.iterations());
  state.counters["per_s"] = Counter(2.0 * kLanes * kSums * turns, Counter::kIsRate);
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

const std::size_t kAll = std::max(1U, std::thread::hardware_concurrency());

BENCHMARK_CAPTURE(copy, , 1)->Name("ceiling/copy");
BENCHMARK(read)->Name("ceiling/read");
BENCHMARK_CAPTURE(flops, , 1)->Name("ceiling/flops");
BENCHMARK_CAPTURE(copy, , kAll)->Name("ceiling/copy/threads:all")->UseRealTime();
BENCHMARK_CAPTURE(flops, , kAll)->Name("ceiling/flops/threads:all")->UseRealTime();

}  // namespace
}  // namespace fathom::bench
