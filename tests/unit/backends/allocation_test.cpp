// SPDX-License-Identifier: Apache-2.0
// A plan holds everything that scoring needs: after it is made, nothing is allocated.
#include <cstdlib>

#include "engine/window.hpp"
#include "tests/unit/backends/allocations.hpp"
#include "tests/unit/backends/cpu_devices.hpp"

namespace fathom {
namespace {

using test::allocations;

/// Keeps the compiler from leaving out an allocation that nobody uses.
template <class T>
T* used(T* pointer) {
  asm volatile("" : : "g"(pointer) : "memory");
  return pointer;
}

// The judge judged: a counter that misses one way to allocate would prove nothing.
TEST(Allocations, AreCountedHoweverTheyAreMade) {
  struct alignas(128) Wide {
    char bytes[128];
  };
  const auto counted = [](const auto& allocate) {
    const std::size_t before = allocations();
    allocate();
    return allocations() - before;
  };
  EXPECT_EQ(counted([] {}), 0U);
  EXPECT_EQ(counted([] { delete used(new int); }), 1U);
  EXPECT_EQ(counted([] { delete[] used(new char[1000]); }), 1U);
  EXPECT_EQ(counted([] { delete used(new Wide); }), 1U);
  EXPECT_EQ(counted([] { std::free(used(std::malloc(10))); }), 1U);
  EXPECT_EQ(counted([] { std::free(used(std::calloc(10, 10))); }), 1U);
#ifndef __SANITIZE_THREAD__  // GCC 12's does not tell of these
  EXPECT_EQ(counted([] { std::free(used(std::aligned_alloc(64, 640))); }), 1U);
  EXPECT_EQ(counted([] {
              void* memory = nullptr;
              if (::posix_memalign(&memory, 64, 640) == 0) std::free(used(memory));
            }),
            1U);
#endif
  EXPECT_GE(counted([] { std::free(used(std::realloc(used(std::malloc(10)), 10000))); }), 2U);
}

class Allocation : public test::EveryCpuDevice {
 protected:
  /// Allocations of one score() of all windows, of one submit() and wait(), and of one window.
  static std::size_t of_scoring(Plan& plan, const test::Batch& batch, std::span<double> values) {
    const std::span<const Window> windows = batch.windows;
    const std::size_t before = allocations();
    plan.score(batch.frame, windows, values);
    plan.wait(plan.submit(batch.frame, windows, values));
    plan.score(batch.frame, windows.first(1), values.first(plan.spec().outputs()));
    if (plan.spec().outputs() == 1) plan.score(batch.frame, windows[0]);
    return allocations() - before;
  }
};
FATHOM_EVERY_CPU_DEVICE(Allocation);

// Not even the first call allocates.
TEST_P(Allocation, OneThreadNeverAllocates) {
  const auto device = open(1);
  for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
    for (const char* metric :
         {"fft:{}:hann", "fft:{}:none:power", "fft:{}:hann:band=0-0.25", "walsh-sequency:{}",
          "walsh-sequency:{}:band=0-0.25", "walsh-paley:{}:hann", "walsh-hadamard:{}:power",
          "fft:{}:hann:power:rings=4", "fft:{}:none:rings=3", "walsh-sequency:{}:rings=8",
          "walsh-sequency:{}:hann:rings=2", "dct:{}:power", "dct:{}:entropy:band=0-0.4",
          "dct:{}:rings=2"}) {
      std::string text = metric;
      text.replace(text.find("{}"), 2, std::to_string(n));
      for (const int bits : {8, 16}) {
        // Half smooth: some windows are scored again in double.
        const test::Batch batch(text, bits, n <= 64 ? 40 : 5, 5, "half smooth");
        const auto plan = device->plan(batch.spec, batch.windows.size());
        std::vector<double> values(batch.windows.size() * batch.spec.outputs());
        EXPECT_EQ(of_scoring(*plan, batch, values), 0U) << text << ", " << bits << " bits";
      }
    }
  }
}

// With several threads the plan itself still allocates nothing, but oneTBB does, about four times
// for each of its threads when that one first takes part. Which call that is, nobody can say: on a
// machine with fewer processors than threads the last one has been seen to turn up in the 17 000th.
// So what is guaranteed after the first call is a number that does not grow with the calls.
TEST_P(Allocation, SeveralThreadsAllocateOnlyWhenTheyFirstTakePart) {
  constexpr int kCalls = 1000;
  for (const int threads : {2, 3, 7}) {
    const auto device = open(threads);
    const test::Batch batch("walsh-sequency:8", 8, 331);
    const auto plan = device->plan(batch.spec, batch.windows.size());
    std::vector<double> scores(batch.windows.size());
    of_scoring(*plan, batch, scores);
    std::size_t later = 0;
    for (int call = 0; call < kCalls; ++call) later += of_scoring(*plan, batch, scores);
    EXPECT_LE(later, 16U * threads) << "in " << kCalls << " calls on " << threads << " threads";
  }
}

}  // namespace
}  // namespace fathom
