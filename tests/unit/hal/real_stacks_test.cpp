// SPDX-License-Identifier: Apache-2.0
// Recorded stacks that cameras and microscopes made; skipped where they are not at hand.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "hal/rig_driver.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

std::filesystem::path real_data() {
  const char* folder = std::getenv("FATHOM_DATA");
  return folder != nullptr ? folder : FATHOM_TEST_DATA;
}

TEST(RealStacks, AFolderOfCameraPictures) {
  const auto folder = real_data() / "pcb-depthmap";
  if (!exists(folder)) GTEST_SKIP() << "no " << folder << "; set FATHOM_DATA";
  const Hardware rig = open_hardware("replay:" + folder.string());
  EXPECT_EQ(rig.lens->info().highest, 9);
  EXPECT_EQ(rig.lens->info().unit, "frames");
  EXPECT_EQ(rig.camera->settings(), (CameraSettings{2048, 1536, Depth::bits8, 0}));
  rig.lens->move_to(6);
  EXPECT_EQ(rig.camera->grab(1s)->lens_position, 6);
}

TEST(RealStacks, AMicroscopeStackByItselfAndByItsFolder) {
  const auto path = real_data() / "brightfield" / "BF.tif";
  if (!exists(path)) GTEST_SKIP() << "no " << path << "; set FATHOM_DATA";
  for (const auto& source : {path, path.parent_path()}) {
    const Hardware rig = open_hardware("replay:" + source.string());
    // ImageJ's description tells that the 34 planes are 0.3 um apart.
    EXPECT_EQ(rig.lens->info().unit, "um");
    EXPECT_EQ(rig.lens->info().stops.size(), 34u);
    EXPECT_EQ(rig.lens->info().highest, 9.9);
    EXPECT_EQ(rig.camera->settings().depth, Depth::bits16);
    rig.lens->move_to(9.9);
    EXPECT_TRUE(rig.camera->grab(1s));
  }
}

}  // namespace
}  // namespace fathom::test
