// SPDX-License-Identifier: Apache-2.0
// Pictures that cameras and microscopes made; skipped where they are not at hand.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "pictures/picture.hpp"

namespace fathom::test {
namespace {

std::filesystem::path real_data() {
  const char* folder = std::getenv("FATHOM_DATA");
  return folder != nullptr ? folder : FATHOM_TEST_DATA;
}

TEST(RealPictures, CameraJpegs) {
  const auto folder = real_data() / "pcb-depthmap";
  if (!exists(folder)) GTEST_SKIP() << "no " << folder << "; set FATHOM_DATA";
  for (int i = 0; i < 10; ++i) {
    PictureFile file(folder / ("pcb_00" + std::to_string(i) + ".JPG"));
    EXPECT_EQ(file.format(), PictureFormat::jpeg);
    EXPECT_EQ(file.shape(), (PictureShape{2048, 1536, Depth::bits8}));
    if (i % 5 == 0) {
      EXPECT_EQ(file.read().width_px(), 2048);
    }
  }
}

TEST(RealPictures, MicroscopeStack) {
  const auto path = real_data() / "brightfield" / "BF.tif";
  if (!exists(path)) GTEST_SKIP() << "no " << path << "; set FATHOM_DATA";
  PictureFile file(path);
  ASSERT_EQ(file.page_count(), 34u);
  for (std::size_t page = 0; page < 34; ++page) {
    const Frame frame = file.read(page);
    EXPECT_EQ(frame.depth(), Depth::bits16);
    EXPECT_GT(frame.at(frame.width_px() / 2, frame.height_px() / 2), 0u);
  }
}

}  // namespace
}  // namespace fathom::test
