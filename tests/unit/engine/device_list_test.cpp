// SPDX-License-Identifier: Apache-2.0
#include "engine/device_list.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/file.hpp"
#include "engine/findings.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/engine/fake_devices.hpp"

namespace fathom {
namespace {

class DeviceList : public ::testing::Test {
 protected:
  void SetUp() override {
    setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1);
    backend_.driver_files = "driver 1";
  }
  void TearDown() override { unsetenv("XDG_CACHE_HOME"); }

  std::vector<DeviceInfo> known() const { return known_devices(backend_, {}, world_.clock); }

  test::TemporaryFolder folder_;
  test::FakeWorld world_;
  test::FakeBackend backend_{
      world_,
      "vulkan",
      {{"llvmpipe", DeviceKind::software, "LLVM 15, 256 bits"}, {"GeForce", DeviceKind::gpu, ""}},
      {}};
};

TEST_F(DeviceList, IsKeptAsItWas) {
  known();
  const auto devices = known();
  EXPECT_EQ(backend_.listed, 1);
  ASSERT_EQ(devices.size(), 2U);
  EXPECT_EQ(devices[0].name, "llvmpipe");
  EXPECT_EQ(devices[0].kind, DeviceKind::software);
  EXPECT_EQ(devices[0].details, "LLVM 15, 256 bits");
  EXPECT_EQ(devices[1].name, "GeForce");
  EXPECT_EQ(devices[1].kind, DeviceKind::gpu);
  EXPECT_EQ(devices[1].details, "");
}

TEST_F(DeviceList, IsAskedForAgainWhereDriversChanged) {
  known();
  backend_.driver_files = "driver 2";
  known();
  EXPECT_EQ(backend_.listed, 2);
}

TEST_F(DeviceList, IsAskedForAgainWhenItIsOld) {
  known();
  world_.clock.pass(kOld_s + 1);
  known();
  EXPECT_EQ(backend_.listed, 2);
}

TEST_F(DeviceList, IsAskedForAgainWhenItWasForgotten) {
  known();
  forget_devices(backend_);
  known();
  EXPECT_EQ(backend_.listed, 2);
}

TEST_F(DeviceList, OfNoDevicesIsKeptToo) {
  backend_.infos.clear();
  known();
  EXPECT_TRUE(known().empty());
  EXPECT_EQ(backend_.listed, 1);
}

TEST_F(DeviceList, IsNotKeptWhereNobodyKnowsTheDrivers) {
  backend_.driver_files.clear();
  known();
  known();
  EXPECT_EQ(backend_.listed, 2);
}

TEST_F(DeviceList, IsNotKeptWithoutACache) {
  setenv("FATHOM_CACHE", "none", 1);
  known();
  known();
  unsetenv("FATHOM_CACHE");
  EXPECT_EQ(backend_.listed, 2);
}

TEST_F(DeviceList, IsRenewedByWhoeverAsksTheDrivers) {
  known();
  backend_.infos.pop_back();
  list_devices(backend_, world_.clock);
  EXPECT_EQ(known().size(), 1U);
}

}  // namespace
}  // namespace fathom
