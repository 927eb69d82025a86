// SPDX-License-Identifier: Apache-2.0
#include "engine/crossover.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/cache.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/engine/fake_devices.hpp"

namespace fathom {
namespace {

using test::FakeCost;
using test::FakeDevice;

class Crossover : public ::testing::Test {
 protected:
  void SetUp() override { setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1); }
  void TearDown() override { unsetenv("XDG_CACHE_HOME"); }

  FakeDevice device(const char* name, const FakeCost& cost, const char* details = "driver 1") {
    return {{name, DeviceKind::gpu, details}, "", cost, calls_};
  }

  test::TemporaryFolder folder_;
  int calls_ = 0;
  MetricSpec spec_ = MetricSpec::parse("fft:8");
};

TEST_F(Crossover, IsWhereTheCallHasPaid) {
  FakeDevice gpu = device("gpu", {200, 0}), cpu = device("cpu", {0, 1});
  const std::size_t from = measure_crossover(gpu, cpu, spec_);
  // 200 windows; a machine that is busy may cost one step.
  EXPECT_GE(from, 128U);
  EXPECT_LE(from, 512U);
}

TEST_F(Crossover, IsTheFewestForAGpuThatAlwaysWins) {
  FakeDevice gpu = device("gpu", {0, 0}), cpu = device("cpu", {0, 5});
  EXPECT_EQ(measure_crossover(gpu, cpu, spec_), kFewestForGpu);
}

TEST_F(Crossover, IsNeverForAGpuThatAlwaysLoses) {
  FakeDevice gpu = device("gpu", {0, 1}), cpu = device("cpu", {0, 0.1});
  EXPECT_EQ(measure_crossover(gpu, cpu, spec_), kNever);
}

TEST_F(Crossover, IsMeasuredOnceForADeviceAndMetric) {
  FakeDevice gpu = device("gpu", {200, 0}), cpu = device("cpu", {0, 1});
  const std::size_t from = crossover("vulkan", gpu, cpu, spec_);
  const int measured = calls_;
  EXPECT_GT(measured, 0);
  EXPECT_EQ(crossover("vulkan", gpu, cpu, spec_), from);
  EXPECT_EQ(calls_, measured) << "measured again";

  crossover("vulkan", gpu, cpu, MetricSpec::parse("walsh-paley:8"));
  EXPECT_GT(calls_, measured) << "another metric";
  const int both = calls_;
  EXPECT_EQ(crossover("vulkan", gpu, cpu, spec_), from);
  EXPECT_EQ(calls_, both) << "the second metric drove out the first";
}

TEST_F(Crossover, IsMeasuredAgainForAnotherDriver) {
  FakeDevice gpu = device("gpu", {0, 1}), cpu = device("cpu", {0, 0.1});
  EXPECT_EQ(crossover("vulkan", gpu, cpu, spec_), kNever);
  FakeDevice updated = device("gpu", {0, 0}, "driver 2");
  EXPECT_EQ(crossover("vulkan", updated, cpu, spec_), kFewestForGpu);
}

}  // namespace
}  // namespace fathom
