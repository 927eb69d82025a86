// SPDX-License-Identifier: Apache-2.0
// Several plans at once, each on a thread of its own, as the contract allows. The thread sanitizer
// watches this one.
#include <thread>

#include "tests/support/oracle_compare.hpp"
#include "tests/unit/backends/cpu_devices.hpp"

namespace fathom {
namespace {

using test::Batch;
using test::bit_equal;

std::vector<Batch> different_work() {
  std::vector<Batch> work;
  std::uint64_t seed = 1;
  for (const char* metric : {"fft:64:hann", "walsh-sequency:8", "fft:16:hann:power",
                             "walsh-paley:32:hann", "walsh-sequency:128", "dct:32:entropy"}) {
    work.emplace_back(metric, seed % 2 == 0 ? 16 : 8, 120, seed);
    ++seed;
  }
  return work;
}

/// Runs every batch at once, a thread and a plan for each, on devices[i % devices], and compares
/// with what one thread alone gives.
void expect_right_scores_at_once(const std::vector<std::unique_ptr<Device>>& devices,
                                 const std::vector<std::unique_ptr<Device>>& single) {
  const auto work = different_work();
  std::vector<std::vector<double>> got(work.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < work.size(); ++i) {
    threads.emplace_back([&, i] {
      const auto plan = devices[i % devices.size()]->plan(work[i].spec, work[i].windows.size());
      got[i].resize(work[i].windows.size());
      for (int round = 0; round < 3; ++round) plan->score(work[i].frame, work[i].windows, got[i]);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < work.size(); ++i) {
    const auto expected = work[i].scores_on(*single[i % single.size()]);
    for (std::size_t w = 0; w < expected.size(); ++w) {
      ASSERT_TRUE(bit_equal(got[i][w], expected[w])) << work[i].spec.text() << ", window " << w;
    }
  }
}

class Concurrency : public test::EveryCpuDevice {};
FATHOM_EVERY_CPU_DEVICE(Concurrency);

TEST_P(Concurrency, PlansOfOneDevice) {
  for (const int threads : {1, 2, 3}) {  // fewer than callers, so that some must queue
    std::vector<std::unique_ptr<Device>> device, single;
    device.push_back(open(threads));
    single.push_back(open(1));
    expect_right_scores_at_once(device, single);
  }
}

TEST_P(Concurrency, PlansOfOneInstructionSetOpenedTwice) {
  std::vector<std::unique_ptr<Device>> devices, single;
  for (const int threads : {2, 3}) devices.push_back(open(threads));
  single.push_back(open(1));
  expect_right_scores_at_once(devices, single);
}

TEST(ConcurrencyOfDevices, PlansOfAllInstructionSets) {
  if (test::cpu().devices().empty()) GTEST_SKIP() << "the cpu backend has no device here";
  std::vector<std::unique_ptr<Device>> devices, single;
  for (std::size_t i = 0; i < test::cpu().devices().size(); ++i) {
    devices.push_back(test::open_cpu(i, 3));
    single.push_back(test::open_cpu(i, 1));
  }
  expect_right_scores_at_once(devices, single);
}

// A device may be opened, used and closed while others compute.
TEST_P(Concurrency, DevicesComeAndGo) {
  const Batch batch("walsh-sequency:16", 8, 100);
  const auto expected = batch.scores_on(*open(1));
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i) {
    threads.emplace_back([&] {
      for (int round = 0; round < 5; ++round) EXPECT_EQ(batch.scores_on(*open(2)), expected);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace fathom
