// SPDX-License-Identifier: Apache-2.0
// How many threads there are, and that nobody can tell from the scores.
#include "backends/cpu/threads.hpp"

#include <oneapi/tbb/global_control.h>
#include <stdlib.h>  // setenv

#include <time.h>

#include <atomic>
#include <chrono>
#include <optional>

#include "tests/support/expect_error.hpp"
#include "tests/support/oracle_compare.hpp"
#include "tests/unit/backends/cpu_devices.hpp"

namespace fathom {
namespace {

using test::bit_equal;
using test::expect_error;

/// FATHOM_THREADS for the time of a test.
class ThreadsVariable {
 public:
  explicit ThreadsVariable(const char* value) {
    const char* const before = std::getenv(kName);
    if (before != nullptr) before_ = before;
    set(value);
  }
  ~ThreadsVariable() { set(before_ ? before_->c_str() : nullptr); }
  ThreadsVariable(const ThreadsVariable&) = delete;
  ThreadsVariable& operator=(const ThreadsVariable&) = delete;

 private:
  static constexpr const char* kName = "FATHOM_THREADS";
  static void set(const char* value) {
    value == nullptr ? ::unsetenv(kName) : ::setenv(kName, value, 1);
  }
  std::optional<std::string> before_;
};

TEST(ThreadCount, IsWhatTheVariableSays) {
  for (const int count : {1, 2, 7, 1024}) {
    const ThreadsVariable variable(std::to_string(count).c_str());
    EXPECT_EQ(cpu::thread_count(0), count);
  }
}

TEST(ThreadCount, IsWhatThereIsWhereTheVariableSaysNothing) {
  for (const char* nothing : {static_cast<const char*>(nullptr), ""}) {
    const ThreadsVariable variable(nothing);
    EXPECT_GE(cpu::thread_count(0), 1);
  }
}

TEST(ThreadCount, OptionsWinOverTheVariable) {
  const ThreadsVariable variable("5");
  EXPECT_EQ(cpu::thread_count(3), 3);
  const ThreadsVariable nonsense("two");
  EXPECT_EQ(cpu::thread_count(3), 3) << "nobody asked the variable";
}

TEST(ThreadCount, RefusesWhatIsNoNumberOfThreads) {
  for (const char* text : {"0", "-1", "two", "4x", "x4", " 4", "4 ", "+4", "4.0", "0x4", "1025",
                           "2147483648", "99999999999", "99999999999999999999999"}) {
    SCOPED_TRACE(text);
    const ThreadsVariable variable(text);
    expect_error(ErrorCode::bad_argument, [] { cpu::thread_count(0); }, {"FATHOM_THREADS", text});
  }
  for (const int count : {-1, -2147483647 - 1, 1025, 2147483647}) {
    expect_error(ErrorCode::bad_argument, [&] { cpu::thread_count(count); },
                 {std::to_string(count).c_str()});
  }
}

TEST(ThreadCount, DevicesAskForIt) {
  if (test::cpu().devices().empty()) GTEST_SKIP() << "the cpu backend has no device here";
  const ThreadsVariable variable("two");
  expect_error(ErrorCode::bad_argument, [] { test::open_cpu(0, 0); }, {"FATHOM_THREADS", "two"});
  expect_error(ErrorCode::bad_argument, [] { test::open_cpu(0, -1); });
  EXPECT_NE(test::open_cpu(0, 2), nullptr);
}

TEST(ThreadCount, IsNeverMoreThanCanCompute) {
  using oneapi::tbb::global_control;
  const global_control limit(global_control::max_allowed_parallelism, 2);
  EXPECT_EQ(cpu::Threads(1).count(), 1U);
  EXPECT_EQ(cpu::Threads(2).count(), 2U);
  EXPECT_EQ(cpu::Threads(1024).count(), 2U) << "each would have scratch memory";
  if (test::cpu().devices().empty()) GTEST_SKIP() << "the cpu backend has no device here";
  EXPECT_EQ(test::open_cpu(0, 1)->threads(), 1);
  EXPECT_EQ(test::open_cpu(0, 1024)->threads(), 2);
}

TEST(ThreadCount, IsOneWhereABackendSaysNothing) {
  EXPECT_EQ(test::backend_called("reference").open(0, {7})->threads(), 1);
}

// Every item once, no worker number twice at a time: scratch memory depends on it.
TEST(Share, GivesEveryItemToOneWorkerAtATime) {
  for (const int count : {1, 2, 7}) {
    cpu::Threads threads(count);
    ASSERT_EQ(threads.count(), static_cast<std::size_t>(count));
    for (const std::size_t items : {0, 1, 2, 3, 16, 100, 1000}) {
      for (const std::size_t workers : {1, 2, 7}) {
        if (workers > threads.count()) continue;
        std::vector<std::atomic<int>> done(items), busy(workers);
        std::atomic<int> collisions = 0;
        threads.share(items, workers, [&](std::size_t begin, std::size_t end, std::size_t worker) {
          collisions += busy.at(worker).fetch_add(1) != 0;
          for (std::size_t i = begin; i < end; ++i) ++done.at(i);
          --busy.at(worker);
        });
        EXPECT_EQ(collisions, 0);
        for (const auto& times : done) ASSERT_EQ(times, 1) << items << " items on " << workers;
      }
    }
  }
}

TEST(Share, WorkHappensBeforeItReturns) {
  cpu::Threads threads(3);
  std::vector<int> plain(1000);  // not atomic: the thread sanitizer sees what is missing
  for (int round = 1; round <= 20; ++round) {
    threads.share(plain.size(), 3, [&](std::size_t begin, std::size_t end, std::size_t) {
      for (std::size_t i = begin; i < end; ++i) ++plain[i];
    });
    ASSERT_EQ(plain, std::vector<int>(plain.size(), round));
  }
}

class ThreadIndependence : public test::EveryCpuDevice {
 protected:
  static void expect_the_same_on_any_number_of_threads(const test::Batch& batch) {
    const std::size_t count = batch.windows.size();
    SCOPED_TRACE(batch.spec.text() + ", " + (batch.frame.depth() == Depth::bits8 ? "8" : "16") +
                 " bits, " + std::to_string(count) + " windows");
    const auto expected = batch.scores_on(*open(1));
    for (const int threads : {2, 3, 7}) {
      const auto got = batch.scores_on(*open(threads));
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_TRUE(bit_equal(got[i], expected[i])) << threads << " threads, window " << i;
      }
    }
  }
};
FATHOM_EVERY_CPU_DEVICE(ThreadIndependence);

TEST_P(ThreadIndependence, ScoresAreTheSameToTheLastBit) {
  for (const char* metric : {"fft:8:hann", "fft:16:hann", "fft:64:hann", "walsh-sequency:8",
                             "walsh-sequency:64", "walsh-sequency:128", "walsh-paley:32:hann"}) {
    for (const int bits : {8, 16}) {
      // Less than a block, blocks with a rest, and enough for every thread to take some.
      for (const std::size_t count : {5, 33, 331}) {
        expect_the_same_on_any_number_of_threads({metric, bits, count});
      }
    }
  }
}

// Windows so large that a batch of few is shared out one by one.
TEST_P(ThreadIndependence, ScoresOfLargeWindowsAreTheSameToTheLastBit) {
  for (const char* metric : {"fft:128:hann", "fft:256:none", "walsh-sequency:256",
                             "walsh-paley:128:hann", "fft:256:hann:band=0-0.25"}) {
    for (const int bits : {8, 16}) {
      for (const std::size_t count : {5, 16, 33}) {
        expect_the_same_on_any_number_of_threads({metric, bits, count});
      }
    }
  }
}

/// The same pixels in a frame of 16 bits, whose Fourier scores are all computed in double.
Frame widened(const Frame& frame) {
  std::vector<std::uint16_t> pixels;
  for (int y = 0; y < frame.height_px(); ++y) {
    for (int x = 0; x < frame.width_px(); ++x) {
      pixels.push_back(static_cast<std::uint16_t>(frame.at(x, y)));
    }
  }
  return Frame(frame.width_px(), frame.height_px(), std::move(pixels));
}

// Of a block with smooth windows, those that float is not trusted with are gathered into a new one.
TEST_P(ThreadIndependence, ScoresComputedAgainInDoubleAreTheSameToTheLastBit) {
  for (const char* metric :
       {"fft:16:hann", "fft:32:none", "fft:64:hann", "fft:128:tukey=0.25", "fft:256:hann"}) {
    SCOPED_TRACE(metric);
    const std::size_t count = 49;
    const test::Batch batch(metric, 8, count, 5, "half smooth");
    const auto scores = batch.scores_on(*open(1));
    std::vector<double> in_double(count);
    open(1)->plan(batch.spec, count)->score(widened(batch.frame), batch.windows, in_double);
    std::size_t same = 0;
    for (std::size_t i = 0; i < count; ++i) same += scores[i] == in_double[i];
    EXPECT_GE(same, 5U) << "no window was scored in double";
    EXPECT_LE(same, count - 5) << "every window was scored in double";
    expect_the_same_on_any_number_of_threads(batch);
  }
}

/// Seconds of processor time.
double seconds(clockid_t clock) {
  timespec time;
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// A few large windows are work for several threads: the rest of the process uses more processor
// time than threads of tests before this one could on their way to sleep.
TEST_P(ThreadIndependence, FewLargeWindowsKeepMoreThanOneThreadBusy) {
  using std::chrono::steady_clock;
  constexpr double kEnough = 0.005;
  for (const auto& [metric, count] : {std::pair("fft:512:hann", 16),
                                      {"fft:256:hann", 4},
                                      {"walsh-sequency:512", 16},
                                      {"walsh-sequency:256", 4}}) {
    const test::Batch batch(metric, 8, static_cast<std::size_t>(count));
    const auto device = open(2);
    const auto plan = device->plan(batch.spec, batch.windows.size());
    std::vector<double> scores(batch.windows.size());
    const double all_before = seconds(CLOCK_PROCESS_CPUTIME_ID);
    const double own_before = seconds(CLOCK_THREAD_CPUTIME_ID);
    double others = 0;
    // On a machine that has more to do the second thread may come late, but it comes.
    const auto give_up = steady_clock::now() + std::chrono::seconds(30);
    while (others < kEnough && steady_clock::now() < give_up) {
      plan->score(batch.frame, batch.windows, scores);
      const double own = seconds(CLOCK_THREAD_CPUTIME_ID) - own_before;
      others = seconds(CLOCK_PROCESS_CPUTIME_ID) - all_before - own;
    }
    EXPECT_GE(others, kEnough) << count << " windows of " << metric;
  }
}

}  // namespace
}  // namespace fathom
