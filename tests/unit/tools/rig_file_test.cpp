// SPDX-License-Identifier: Apache-2.0
// A rig that was typed, as the file that `fathom rigs check` prints: it opens the same rig.
#include "tools/fathom/rig_file.hpp"

#include <gtest/gtest.h>

#include "engine/file.hpp"
#include "hal/rig_text.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::cli {
namespace {

void expect_the_same(const RigPart& part, const RigPart& again) {
  EXPECT_EQ(part.driver, again.driver);
  EXPECT_EQ(part.settings.values(), again.settings.values());
}

TEST(RigFile, OpensTheSameRigAsItsText) {
  for (const char* const text :
       {"sim", "sim:distance=1500,seed=007,target=usaf,noise=0.5,drift=-0,fnumber=4.10",
        "indi:localhost:7624", "alpaca:10.0.0.7,camera=Sky \"A\" \\ b,gain=1e3",
        "alpaca:10.0.0.7,binning=2"}) {
    const RigRequest request = parse_rig(text);
    const RigRequest again = parse_rig_file(rig_file_text(text, std::nullopt), "my-rig.toml");
    expect_the_same(request.camera, again.camera);
    EXPECT_FALSE(again.lens);
  }
}

TEST(RigFile, PutsWhatWasMeasuredInPlaceOfWhatWasSaid) {
  const LensSettings lens{.settle_ms = 220, .backlash = 8.5, .coarse = 35};
  const auto values = parse_rig_file(rig_file_text("indi:here,settle_ms=5", lens), "my-rig.toml")
                          .camera.settings.values();
  EXPECT_EQ(values.at("server"), "here");
  EXPECT_EQ(values.at("settle_ms"), "220");
  EXPECT_EQ(values.at("backlash"), "8.5");
  EXPECT_EQ(values.at("coarse"), "35");
}

TEST(RigFile, KeepsTheTablesOfTwoDrivers) {
  const test::TemporaryFolder folder;
  const std::string file = (folder / "desk.toml").string();
  write_file(file,
             "[camera]\ndriver = \"sim\"\nseed = 3\n[lens]\ndriver = \"indi\"\nbacklash = 4\n");
  const LensSettings lens{.settle_ms = 90, .backlash = 12, .coarse = 40};
  const RigRequest again = parse_rig_file(rig_file_text(file, lens), "my-rig.toml");
  expect_the_same(parse_rig(file).camera, again.camera);
  ASSERT_TRUE(again.lens);
  EXPECT_EQ(again.lens->settings.values().at("backlash"), "12");
  EXPECT_FALSE(again.camera.settings.has("settle_ms"));
}

}  // namespace
}  // namespace fathom::cli
