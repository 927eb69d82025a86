// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "engine/file.hpp"
#include "hal/drivers/replay/stack.hpp"
#include "hal/rig_driver.hpp"
#include "pictures/picture.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

/// A frame whose every pixel is `grey`, so that a test sees which one it was given.
Frame plain(std::uint8_t grey, int width = 8, int height = 8) {
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  return Frame(width, height, std::vector<std::uint8_t>(count, grey));
}

class Replay : public testing::Test {
 protected:
  void picture(const std::string& name, std::uint8_t grey) {
    write_picture(folder_ / name, plain(grey));
  }
  void manifest(const std::string& text) { write_file(folder_ / "manifest.csv", text); }
  Hardware open() { return open_hardware("replay:" + folder_.path().string()); }
  void expect_refused(ErrorCode code, std::initializer_list<const char*> texts) {
    expect_error(
        code, [this] { open(); }, texts);
  }
  static std::uint32_t grey(Hardware& rig) { return rig.camera->grab(1s).value().at(0, 0); }

  TemporaryFolder folder_;
};

TEST(NaturalOrder, CountsAsPeopleDo) {
  using replay::natural_less;
  EXPECT_TRUE(natural_less("pcb_2.jpg", "pcb_10.jpg"));
  EXPECT_FALSE(natural_less("pcb_10.jpg", "pcb_2.jpg"));
  EXPECT_TRUE(natural_less("pcb_002.jpg", "pcb_10.jpg"));
  EXPECT_TRUE(natural_less("a", "b"));
  EXPECT_TRUE(natural_less("a", "a1"));
  EXPECT_TRUE(natural_less("a1b2", "a1b10"));
  EXPECT_TRUE(natural_less("a99999999999999999999998", "a99999999999999999999999"));
  EXPECT_FALSE(natural_less("a", "a"));
  // Names that differ by zeros only still have one order.
  EXPECT_NE(natural_less("x_01", "x_1"), natural_less("x_1", "x_01"));
}

TEST_F(Replay, AFrameOutlivesTheNextOneAndTheCamera) {
  picture("f_1.png", 10);
  picture("f_2.png", 20);
  Hardware rig = open();
  const Frame first = rig.camera->grab(1s).value();
  rig.lens->move_to(rig.lens->info().highest);
  EXPECT_EQ(grey(rig), 20U);
  rig = Hardware();
  EXPECT_EQ(first.at(7, 7), 10U);
}

TEST_F(Replay, WithoutManifestTheOrderGivesThePositions) {
  picture("f_10.png", 10);
  picture("f_2.pgm", 2);
  picture("f_1.tif", 1);
  write_file(folder_ / "README.md", "not a picture");
  write_file(folder_ / ".hidden.png", "not a picture either");
  std::filesystem::create_directory(folder_ / "folder.png");
  Hardware rig = open();
  const LensInfo info = rig.lens->info();
  EXPECT_EQ(info.unit, "frames");
  EXPECT_EQ(info.lowest, 0);
  EXPECT_EQ(info.highest, 2);
  EXPECT_EQ(info.resolution, 1);
  EXPECT_EQ(info.coarse_spacing, 1);
  EXPECT_EQ(grey(rig), 1u);
  rig.lens->move_to(1);
  EXPECT_EQ(grey(rig), 2u);
  rig.lens->move_to(2);
  EXPECT_EQ(grey(rig), 10u);
  rig.lens->home();
  EXPECT_EQ(grey(rig), 1u);
}

TEST_F(Replay, AManifestGivesPositionsAndUnit) {
  picture("a.png", 1);
  picture("b.png", 2);
  picture("c.png", 3);
  picture("unlisted.png", 4);
  manifest(
      "# unit: steps\n# coarse_spacing: 70\nfile,position\nc.png,250\na.png,100\nb.png,120.5\n");
  Hardware rig = open();
  const LensInfo info = rig.lens->info();
  EXPECT_EQ(info.unit, "steps");
  EXPECT_EQ(info.lowest, 100);
  EXPECT_EQ(info.highest, 250);
  EXPECT_EQ(info.resolution, 20.5);
  EXPECT_EQ(info.coarse_spacing, 70);
  EXPECT_EQ(grey(rig), 1u);
  EXPECT_EQ(rig.lens->move_to(250).note, "");
  EXPECT_EQ(grey(rig), 3u);
}

TEST_F(Replay, APositionThatItHasNotBecomesTheNearestAndSaysSo) {
  for (std::uint8_t i = 0; i < 5; ++i) picture(std::to_string(i) + ".png", i);
  Hardware rig = open();
  const Arrival arrival = rig.lens->move_to(3.4);
  EXPECT_EQ(arrival.position, 3);
  EXPECT_EQ(arrival.note, "position 3.4 was not recorded; the nearest, 3, is used");
  EXPECT_EQ(rig.lens->position(), 3);
  EXPECT_EQ(grey(rig), 3u);
  EXPECT_EQ(rig.lens->nearest(3.6), 4);
  EXPECT_EQ(rig.lens->nearest(2.5), 2);
  EXPECT_EQ(rig.lens->nearest(-7), 0);
  EXPECT_EQ(rig.lens->nearest(99), 4);
}

TEST_F(Replay, LongRecordingsHaveACoarserCoarseSpacing) {
  std::string text = "file,position,page\n";
  for (int i = 0; i < 150; ++i) {
    picture(std::to_string(i) + ".pgm", static_cast<std::uint8_t>(i));
    text += std::to_string(i) + ".pgm," + std::to_string(2 * i) + ",0\n";
  }
  manifest(text);
  const LensInfo info = open().lens->info();
  EXPECT_EQ(info.resolution, 2);
  EXPECT_EQ(info.coarse_spacing, 4);  // 298 / 128 = 2.3, up to a multiple of 2
}

TEST_F(Replay, OnePictureIsAStackOfOne) {
  picture("one.png", 9);
  Hardware rig = open_hardware("replay:" + (folder_ / "one.png").string());
  EXPECT_EQ(rig.lens->info().lowest, rig.lens->info().highest);
  EXPECT_GT(rig.lens->info().resolution, 0);
  EXPECT_GT(rig.lens->info().coarse_spacing, 0);
  EXPECT_EQ(grey(rig), 9u);
}

TEST_F(Replay, CameraAndLensOutliveEachOther) {
  picture("a.png", 1);
  picture("b.png", 2);
  Hardware rig = open();
  rig.lens->move_to(1);
  rig.lens = nullptr;
  EXPECT_EQ(grey(rig), 2u);
  Hardware other = open();
  other.camera = nullptr;
  EXPECT_EQ(other.lens->move_to(1).position, 1);
}

TEST_F(Replay, NothingToPlayIsAnError) {
  expect_refused(ErrorCode::bad_data, {"has no pictures in it"});
  write_file(folder_ / "README", "x");
  expect_refused(ErrorCode::bad_data, {"has no pictures in it"});
  manifest("file,position\n");
  expect_refused(ErrorCode::bad_data, {"manifest.csv lists no pictures"});
}

TEST_F(Replay, ManifestMistakesNameFileAndLine) {
  picture("a.png", 1);
  manifest("file,position\na.png,0\ngone.png,1\n");
  expect_refused(ErrorCode::bad_data, {"manifest.csv line 3: there is no file", "gone.png"});
  manifest("file,position\na.png,0\na.png,0\n");
  expect_refused(ErrorCode::bad_data, {"manifest.csv line 3: position 0 is also on line 2"});
  manifest("file,position\na.png,middle\n");
  expect_refused(ErrorCode::bad_data, {"manifest.csv line 2: position \"middle\" is not a number"});
  manifest("file,position,page\na.png,0,1\n");
  expect_refused(ErrorCode::bad_data, {"manifest.csv line 2", "a.png has 1 pages", "no page 1"});
}

TEST_F(Replay, FramesThatAreNotAlikeAreRefusedAtOnce) {
  picture("a.png", 1);
  write_picture(folder_ / "b.png", plain(2, 9, 8));
  expect_refused(ErrorCode::bad_data, {"a.png is 8 x 8 px, 8 bit", "b.png is 9 x 8 px, 8 bit"});
  write_picture(folder_ / "b.png", Frame(8, 8, std::vector<std::uint16_t>(64, 3)));
  expect_refused(ErrorCode::bad_data, {"b.png is 8 x 8 px, 16 bit"});
}

TEST_F(Replay, DamagedPicturesAreNamed) {
  picture("a.png", 1);
  write_file(folder_ / "b.png", "");
  expect_refused(ErrorCode::bad_data, {"b.png", "empty"});
  write_file(folder_ / "b.png", "hello");
  expect_refused(ErrorCode::bad_data, {"b.png is no PNG"});
  // Damage behind the header shows when the frame is wanted.
  const std::string whole = read_file(folder_ / "a.png");
  write_file(folder_ / "b.png", whole.substr(0, whole.size() - 14));
  Hardware rig = open();
  EXPECT_EQ(grey(rig), 1u);
  rig.lens->move_to(1);
  expect_error(ErrorCode::bad_data, [&] { rig.camera->grab(1s); },
               {"b.png is truncated or damaged"});
}

TEST_F(Replay, APictureChangedMeanwhileIsNoticed) {
  picture("a.png", 1);
  picture("b.png", 2);
  Hardware rig = open();
  write_picture(folder_ / "a.png", plain(3, 16, 16));
  expect_error(ErrorCode::bad_data, [&] { rig.camera->grab(1s); }, {"a.png was 8 x 8 px"});
}

}  // namespace
}  // namespace fathom::test
