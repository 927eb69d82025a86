// SPDX-License-Identifier: Apache-2.0
// What happens when the device has no memory left or is lost, and that nothing leaks.
#include <cstdlib>
#include <thread>

#include "engine/error.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/frames.hpp"
#include "tests/support/oracle_compare.hpp"
#include "tests/unit/gpu/layered.hpp"

namespace fathom {
namespace {

using test::bit_equal;
using test::expect_error;

class Faulty : public test::Layered {
 protected:
  const Frame frame_ = test::make_frame("natural", 8, 200, 150, 7);
  const Window window_{3, 5, 16};
};

class Faults : public Faulty, public ::testing::WithParamInterface<std::string> {
 protected:
  std::string name() const override { return GetParam(); }
};
FATHOM_ON_EVERY_GPU_BACKEND(Faults);

constexpr const char* kSpecs[] = {"fft:16:hann", "walsh-sequency:16", "fft:16:hann:band=0-0.25"};

TEST_P(Faults, EverythingThatIsCreatedIsDestroyed) {
  {
    const auto device = open();
    for (const char* text : kSpecs) {
      const auto plan = device->plan(MetricSpec::parse(text), 100);
      const auto windows = window_grid(200, 150, {0, 0, 16}, 20);
      std::vector<double> scores(windows.size());
      plan->score(frame_, windows, scores);
      plan->submit(frame_, windows, scores);  // and is not waited for
      std::vector<std::complex<double>> spectrum(16 * 16);
      plan->spectrum(frame_, window_, spectrum);
    }
  }
  EXPECT_EQ(alive(), "");
  for (const auto& kind : layer().kinds) {
    const std::string kind_name = kind.name != nullptr ? kind.name : "Semaphore";
    if (kind_name != "Semaphore") {  // of a queue for copies, tested in devices_test.cpp
      EXPECT_GT(kind.created, 0) << kind_name << " is not counted at all";
    }
  }
}

// As PoCL does where several processes compile into its cache at once.
TEST_P(Faults, AProgramThatFailsToBuildOnceIsBuiltAgain) {
  if (name() != "opencl") GTEST_SKIP() << "Vulkan's kernels are compiled beforehand";
  layer().refuses_programs = true;  // those of the cache need no building
  const auto device = open();
  layer().failing_builds = 1;
  EXPECT_GT(device->plan(MetricSpec::parse("walsh-sequency:32"), 1)->score(frame_, {0, 0, 32}), 0);
  layer().failing_builds = 1000;
  expect_error(ErrorCode::unavailable, [&] { device->plan(MetricSpec::parse("fft:8"), 1); },
               {"compiling"});
}

TEST_P(Faults, APlanWithoutMemorySaysHowMuchAndKeepsNone) {
  const auto device = open();
  const MetricSpec spec = MetricSpec::parse("fft:16:hann");
  device->plan(spec, 3'000'000);  // compiles, and so counts only what plans allocate below
  const std::string before = alive();
  layer().find("Memory")->created = 0;
  device->plan(spec, 3'000'000);
  const int allocations = layer().created_of("Memory");
  ASSERT_GT(allocations, 5);
  for (int k = 0; k < allocations; ++k) {
    SCOPED_TRACE("allocation " + std::to_string(k));
    layer().allocations_left = k;
    expect_error(ErrorCode::out_of_memory, [&] { device->plan(spec, 3'000'000); },
                 {device->info().name.c_str(), "smaller capacity", k == 3 ? "MiB" : ""});
    EXPECT_EQ(alive(), before);
  }
  layer().allocations_left = -1;
  EXPECT_GT(device->plan(spec, 1)->score(frame_, window_), 0);
}

TEST_P(Faults, AFrameWithoutMemoryLeavesThePlanAsItWas) {
  const auto device = open();
  const auto plan = device->plan(MetricSpec::parse("fft:16:hann"), 4);
  const double before = plan->score(frame_, window_);
  const Frame large = test::make_frame("natural", 8, 900, 700, 7);
  const Window corners[] = {{0, 0, 16}, {884, 684, 16}};
  double scores[2] = {};
  layer().allocations_left = 0;
  expect_error(ErrorCode::out_of_memory, [&] { plan->score(large, corners, scores); },
               {"a frame", "pictures of fewer pixels"});
  EXPECT_TRUE(bit_equal(plan->score(frame_, window_), before));
  plan->score(large, corners, scores);
  EXPECT_GT(scores[1], 0);
}

class Lost : public Faulty, public ::testing::WithParamInterface<std::tuple<std::string, bool>> {
 protected:
  std::string name() const override { return std::get<0>(GetParam()); }
  bool when_submitting() const { return std::get<1>(GetParam()); }
  /// After so many more submissions, or waits, the device is found lost.
  void lose(int after = 0) {
    (when_submitting() ? layer().submissions_left : layer().waits_left) = after;
  }
};
INSTANTIATE_TEST_SUITE_P(On, Lost,
                         ::testing::Combine(::testing::ValuesIn(test::backends_with_layers()),
                                            ::testing::Bool()),
                         [](const auto& at) {
                           return std::get<0>(at.param) +
                                  (std::get<1>(at.param) ? "Submitting" : "Waiting");
                         });

TEST_P(Lost, DeviceIsAnErrorAndTheNextPlanWorks) {
  const auto device = open();
  const MetricSpec spec = MetricSpec::parse("walsh-sequency:16");
  auto plan = device->plan(spec, 4), other = device->plan(spec, 4);
  const double before = plan->score(frame_, window_);
  lose();
  expect_error(ErrorCode::device_lost, [&] { plan->score(frame_, window_); });
  expect_error(ErrorCode::device_lost, [&] { other->score(frame_, window_); });
  const auto fresh = device->plan(spec, 4);
  EXPECT_TRUE(bit_equal(fresh->score(frame_, window_), before));
  plan.reset();
  other.reset();
  EXPECT_TRUE(bit_equal(fresh->score(frame_, window_), before));
}

TEST_P(Lost, DeviceFailsTheBatchesThatItLostAndNoOthers) {
  const auto device = open();
  const auto plan = device->plan(MetricSpec::parse("walsh-sequency:16"), 4);
  double scores[3] = {};
  const auto submit = [&](int i) {
    return plan->submit(frame_, {&window_, 1}, std::span(scores).subspan(i, 1));
  };
  const auto first = submit(0);
  plan->wait(first);
  const auto second = submit(1);
  lose();
  expect_error(ErrorCode::device_lost, [&] { plan->wait(when_submitting() ? submit(2) : second); });
  plan->wait(first);
  EXPECT_GT(scores[0], 0);
}

// The trial of its arithmetic makes plans, too.
TEST_P(Lost, DeviceDoesNotKeepFftFromWorking) {
  const auto device = open();
  const MetricSpec spec = MetricSpec::parse("fft:16:hann");
  const auto plan = device->plan(spec, 4);
  lose();
  expect_error(ErrorCode::device_lost, [&] { plan->score(frame_, window_); });
  EXPECT_GT(device->plan(spec, 4)->score(frame_, window_), 0);
}

TEST_P(Lost, DeviceInTheMiddleOfACallWritesNoMore) {
  layer().buffer_bytes = 65536;  // so that the call takes several batches
  const auto device = open();
  const auto plan = device->plan(MetricSpec::parse("walsh-sequency:16"), 2000);
  const Frame large = test::make_frame("random", 8, 640, 480, 7);
  const auto windows = window_grid(640, 480, {0, 0, 16}, 16);
  std::vector<double> scores(windows.size(), -1);
  lose(1);
  expect_error(ErrorCode::device_lost, [&] { plan->score(large, windows, scores); });
  const auto kept = scores;
  expect_error(ErrorCode::device_lost, [&] { plan->score(frame_, window_); });
  EXPECT_EQ(scores, kept) << "written after the call had failed";
}

/// Devices whose work never ends, as far as the library can see.
class Hanging : public Faults {
 protected:
  void SetUp() override {
    Faults::SetUp();
    // OpenCL's waits last so long here. Vulkan's layer says at once that the time is over.
    if (name() == "opencl") setenv("FATHOM_GPU_TIMEOUT", "0.1", 1);
  }
  void TearDown() override {
    unsetenv("FATHOM_GPU_TIMEOUT");
    EXPECT_NE(alive(), "") << "destroyed though the device may still use it";
    for (auto& kind : layer().kinds) kind.alive = 0;  // kept for ever, and rightly
    Faults::TearDown();
  }
  const MetricSpec spec_ = MetricSpec::parse("walsh-sequency:16");
};
FATHOM_ON_EVERY_GPU_BACKEND(Hanging);

TEST_P(Hanging, DeviceIsGivenUpAndTheNextPlanWorks) {
  const auto device = open();
  const auto plan = device->plan(spec_, 4), other = device->plan(spec_, 4);
  layer().hangs = true;
  expect_error(ErrorCode::timeout, [&] { plan->score(frame_, window_); },
               {device->info().name.c_str(), "did not answer within", "FATHOM_GPU_TIMEOUT"});
  expect_error(ErrorCode::device_lost, [&] { plan->score(frame_, window_); });
  expect_error(ErrorCode::device_lost, [&] { other->score(frame_, window_); });
  layer().hangs = false;
  unsetenv("FATHOM_GPU_TIMEOUT");
  EXPECT_GT(device->plan(spec_, 4)->score(frame_, window_), 0);
}

TEST_P(Hanging, DeviceDoesNotKeepAPlanFromGoing) {
  const auto device = open();
  auto plan = device->plan(spec_, 4);
  double scores[2] = {-1, -1};
  plan->submit(frame_, {&window_, 1}, {scores, 1});
  plan->submit(frame_, {&window_, 1}, {scores + 1, 1});
  layer().hangs = true;
  plan.reset();
  EXPECT_EQ(scores[0], -1);
}

TEST_P(Hanging, DeviceIsGivenUpWhereverItIsWaitedFor) {
  const auto device = open();
  auto plan = device->plan(spec_, 4);
  layer().hangs = true;
  std::vector<std::complex<double>> spectrum(16 * 16);
  expect_error(ErrorCode::timeout, [&] { plan->spectrum(frame_, window_, spectrum); });
  if (name() != "vulkan") return;  // OpenCL's plans are made without waiting
  expect_error(ErrorCode::timeout, [&] { device->plan(spec_, 4); });
}

// Whichever command of a call fails, the error is one of ours, nothing that the device still uses
// goes, and a plan made afterwards works.
TEST_P(Faults, AnyCommandOfACallMayFail) {
  if (name() != "opencl")
    GTEST_SKIP() << "Vulkan's commands are recorded: they fail when submitted";
  for (const bool has_own_memory : {false, true}) {
    layer().has_transfer_queue = has_own_memory;
    const auto device = open();
    const MetricSpec spec = MetricSpec::parse("fft:16:hann");
    const double right = device->plan(spec, 4)->score(frame_, window_);
    int failures = 0;
    for (int k = 0; k < 100; ++k) {
      const auto plan = device->plan(spec, 4);
      plan->score(frame_, window_);
      layer().commands_left = k;
      bool failed = false;
      try {
        plan->score(frame_, window_);
        plan->score(frame_, window_);  // waits for the first, if its scores were lost
      } catch (const Error& error) {
        failed = true;
        EXPECT_TRUE(error.code() == ErrorCode::device_lost ||
                    error.code() == ErrorCode::out_of_memory)
            << k << ": " << error.what();
      }
      const bool was_reached = layer().commands_left < 0;
      layer().commands_left = -1;
      EXPECT_EQ(failed, was_reached) << k;
      EXPECT_TRUE(bit_equal(device->plan(spec, 4)->score(frame_, window_), right)) << k;
      failures += failed;
      if (!was_reached) break;
    }
    EXPECT_GE(failures, 8);
  }
}

TEST_P(Faults, ManyPlansOfManyThreads) {
  const auto device = open();
  std::vector<std::thread> threads;
  std::vector<std::vector<double>> scores(6);
  for (int t = 0; t < 6; ++t) {
    threads.emplace_back([&, t] {
      for (int round = 0; round < 4; ++round) {
        const auto plan = device->plan(MetricSpec::parse(kSpecs[t % 3]), 2);
        for (int i = 0; i < 5; ++i) scores[t].push_back(plan->score(frame_, window_));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (int t = 0; t < 6; ++t) {
    ASSERT_EQ(scores[t].size(), 20U);
    for (const double score : scores[t]) EXPECT_TRUE(bit_equal(score, scores[t % 3][0]));
  }
}

}  // namespace
}  // namespace fathom
