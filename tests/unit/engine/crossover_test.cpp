// SPDX-License-Identifier: Apache-2.0
#include "engine/crossover.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/engine/fake_devices.hpp"

namespace fathom {
namespace {

using test::FakeBackend;
using test::FakeCost;
using test::FakeDevice;

class Crossover : public ::testing::Test {
 protected:
  void SetUp() override { setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1); }
  void TearDown() override { unsetenv("XDG_CACHE_HOME"); }

  FakeDevice device(DeviceKind kind, const FakeCost& cost) {
    return {{kind == DeviceKind::cpu ? "cpu" : "gpu", kind, "driver 1"}, "", cost, world_};
  }
  FakeDevice gpu(const FakeCost& cost) { return device(DeviceKind::gpu, cost); }
  FakeDevice cpu(const FakeCost& cost) { return device(DeviceKind::cpu, cost); }

  std::size_t crossover_of(FakeDevice& gpu, FakeDevice& cpu, const char* metric = "fft:8") {
    return crossover({&backend_, 0, gpu.info()}, gpu, cpu, MetricSpec::parse(metric), world_.clock);
  }
  /// Whether it is used as it stands, without a measurement.
  bool is_known(FakeDevice& gpu, FakeDevice& cpu) {
    const int before = world_.calls;
    crossover_of(gpu, cpu);
    return world_.calls == before;
  }
  void disturb(const std::function<double(DeviceKind, double)>& disturbance) {
    world_.clock.disturbance = disturbance;
  }

  test::TemporaryFolder folder_;
  test::FakeWorld world_;
  FakeBackend backend_{world_, "vulkan", {}, {}};
  MetricSpec spec_ = MetricSpec::parse("fft:8");
};

TEST_F(Crossover, IsWhereTheCallHasPaid) {
  FakeDevice slow_start = gpu({200, 0}), processor = cpu({0, 1});
  const Measured from = measure_crossover(slow_start, processor, spec_, world_.clock);
  EXPECT_EQ(from.value, 256U);  // of 200
  EXPECT_TRUE(from.is_certain);
}

TEST_F(Crossover, IsTheFewestForAGpuThatAlwaysWins) {
  FakeDevice fast = gpu({0, 0}), processor = cpu({0, 5});
  EXPECT_EQ(measure_crossover(fast, processor, spec_, world_.clock).value, kFewestForGpu);
}

TEST_F(Crossover, IsNeverForAGpuThatAlwaysLoses) {
  FakeDevice slow = gpu({0, 1}), processor = cpu({0, 0.1});
  EXPECT_EQ(measure_crossover(slow, processor, spec_, world_.clock).value, kNever);
}

// A second a call, and no time to try all the batches: 3000 us over 1 us a window.
TEST_F(Crossover, IsFoundBeyondWhatThereIsTimeToTry) {
  FakeDevice slow_start = gpu({3e6, 0}), processor = cpu({0, 1000});
  const Measured from = measure_crossover(slow_start, processor, spec_, world_.clock);
  EXPECT_NEAR(static_cast<double>(from.value), 3000, 1);
}

TEST_F(Crossover, IsNotMovedByCallsThatWereDisturbedNowAndThen) {
  FakeDevice slow_start = gpu({200, 0}), processor = cpu({0, 1});
  int call = 0;
  disturb([&](DeviceKind, double) { return ++call % 3 == 0 ? 0.01 : 0.0; });
  EXPECT_EQ(measure_crossover(slow_start, processor, spec_, world_.clock).value, 256U);
}

TEST_F(Crossover, IsUncertainWhereHalfOfTheCallsTellAnotherStory) {
  FakeDevice slow_start = gpu({200, 0}), processor = cpu({0, 1});
  int call = 0;
  disturb([&](DeviceKind kind, double) {
    return kind == DeviceKind::gpu && ++call % 5 != 0 ? 0.01 : 0.0;
  });
  EXPECT_FALSE(measure_crossover(slow_start, processor, spec_, world_.clock).is_certain);
}

TEST_F(Crossover, IsUncertainWhereTheProcessorWasTakenAway) {
  FakeDevice slow_start = gpu({200, 0}), processor = cpu({0, 1});
  disturb(
      [](DeviceKind kind, double takes_s) { return kind == DeviceKind::cpu ? 3 * takes_s : 0.0; });
  const Measured from = measure_crossover(slow_start, processor, spec_, world_.clock);
  EXPECT_EQ(from.value, 64U);  // where the CPU would be at 256
  EXPECT_FALSE(from.is_certain);
}

TEST_F(Crossover, IsMeasuredOnceForADeviceAndMetric) {
  FakeDevice slow_start = gpu({200, 0}), processor = cpu({0, 1});
  EXPECT_EQ(crossover_of(slow_start, processor), 256U);
  EXPECT_GT(world_.calls, 0);
  EXPECT_TRUE(is_known(slow_start, processor));
  const int before = world_.calls;
  crossover_of(slow_start, processor, "walsh-paley:8");
  EXPECT_GT(world_.calls, before) << "another metric";
  EXPECT_TRUE(is_known(slow_start, processor)) << "the second metric drove out the first";
}

TEST_F(Crossover, IsMeasuredAgainForAnotherDriver) {
  FakeDevice slow = gpu({0, 1}), processor = cpu({0, 0.1});
  EXPECT_EQ(crossover_of(slow, processor), kNever);
  backend_.driver_files = "another library";
  FakeDevice updated = gpu({0, 0});
  EXPECT_EQ(crossover_of(updated, processor), kFewestForGpu);
}

TEST_F(Crossover, IsCorrectedAfterABusyMachineLeftAWrongOne) {
  FakeDevice slow_start = gpu({200, 0}), processor = cpu({0, 1});
  // All calls of the GPU last so much longer that nothing looks odd.
  disturb([](DeviceKind kind, double) { return kind == DeviceKind::gpu ? 0.001 : 0.0; });
  EXPECT_EQ(crossover_of(slow_start, processor), 2048U);
  disturb({});
  world_.clock.pass(kApart_s + 1);
  EXPECT_EQ(crossover_of(slow_start, processor), 256U);
  world_.clock.pass(kApart_s + 1);
  EXPECT_FALSE(is_known(slow_start, processor)) << "believed without a second measurement";
  world_.clock.pass(kApart_s + 1);
  EXPECT_TRUE(is_known(slow_start, processor));
}

TEST_F(Crossover, IsCorrectedEvenIfTheMachineWasBusyTwice) {
  FakeDevice slow_start = gpu({200, 0}), processor = cpu({0, 1});
  disturb([](DeviceKind kind, double) { return kind == DeviceKind::gpu ? 0.001 : 0.0; });
  crossover_of(slow_start, processor);
  world_.clock.pass(kApart_s + 1);
  EXPECT_EQ(crossover_of(slow_start, processor), 2048U);
  disturb({});
  world_.clock.pass(kOld_s + 1);
  EXPECT_EQ(crossover_of(slow_start, processor), 256U);
}

TEST_F(Crossover, TheFastestOfSeveralIsFoundAndKept) {
  FakeDevice one = gpu({100, 0.5}), two = gpu({200, 0.1}), three = gpu({300, 0.05});
  Device* const devices[] = {&one, &two, &three};
  EXPECT_EQ(measure_fastest(devices, spec_, 16, world_.clock).value, 0U);
  EXPECT_EQ(measure_fastest(devices, spec_, 1000, world_.clock).value, 1U);
  EXPECT_EQ(measure_fastest(devices, spec_, 4096, world_.clock).value, 2U);
  const Listed listed[] = {
      {&backend_, 0, one.info()}, {&backend_, 1, two.info()}, {&backend_, 2, three.info()}};
  EXPECT_EQ(Rivals(listed, spec_, 1000, world_.clock).known(), std::nullopt);
  EXPECT_EQ(Rivals(listed, spec_, 1000, world_.clock).measure(devices), 1U);
  EXPECT_EQ(Rivals(listed, spec_, 900, world_.clock).known(), 1U) << "nearly as many windows";
  EXPECT_EQ(Rivals(listed, spec_, 16, world_.clock).known(), std::nullopt);
}

}  // namespace
}  // namespace fathom
