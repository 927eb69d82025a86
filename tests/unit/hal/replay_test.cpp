// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "engine/file.hpp"
#include "tests/unit/hal/replay_fixture.hpp"

namespace fathom::test {
namespace {

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
  const auto unnamed = findings_of<UnnamedPictures>(rig);
  ASSERT_EQ(unnamed.size(), 1u);
  EXPECT_EQ(unnamed[0].count, 1u);
  EXPECT_EQ(unnamed[0].first, "unlisted.png");
}

TEST_F(Replay, ARowThatWasCommentedOutIsNoPicture) {
  for (const char* name : {"a.png", "b.png", "#c.png"}) picture(name, 1);
  manifest("file,position\na.png,1\n#b.png,2\n#c.png,3\n");
  const Hardware rig = open();
  EXPECT_EQ(rig.lens->info().stops, (std::vector<double>{1, 3}));
  EXPECT_EQ(findings_of<UnnamedPictures>(rig).at(0).first, "b.png");
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
  expect_refused(ErrorCode::bad_data, {"manifest.csv line 3", "also on line 2"});
  manifest("file,position\na.png,middle\n");
  expect_refused(ErrorCode::bad_data, {"manifest.csv line 2: position \"middle\" is not a number"});
  manifest("file,position,page\na.png,0,1\n");
  expect_refused(ErrorCode::bad_data, {"manifest.csv line 2", "a.png has 1 pages", "no page 1"});
}

TEST_F(Replay, WhatWasTakenForTheRecordingIsTold) {
  for (const int i : {0, 1, 2, 4, 5}) picture("lens_" + std::to_string(i) + ".5.png", 1);
  write_file(folder_ / "a.bmp", "BM");
  write_file(folder_ / "b.BMP", "BM");
  write_file(folder_ / "README", "x");
  const Hardware rig = open();
  const auto order = findings_of<OrderOfNames>(rig);
  ASSERT_EQ(order.size(), 1u);
  EXPECT_TRUE(order[0].by_numbers);
  EXPECT_EQ(order[0].first, "lens_0.5.png");
  EXPECT_EQ(order[0].last, "lens_5.5.png");
  const auto gaps = findings_of<MissingNumbers>(rig);
  ASSERT_EQ(gaps.size(), 1u);
  EXPECT_EQ(gaps[0].count, 1u);
  EXPECT_EQ(gaps[0].before, "lens_2.5.png");
  const auto skipped = findings_of<SkippedFiles>(rig);
  ASSERT_EQ(skipped.size(), 1u);
  ASSERT_EQ(skipped[0].kinds.size(), 2u);
  EXPECT_EQ(skipped[0].kinds[0].name, "bmp");
  EXPECT_EQ(skipped[0].kinds[0].count, 2u);
  EXPECT_EQ(nearest_name(rig.lens->info(), 3.4), "lens_4.5.png");
}

TEST_F(Replay, PipesAndDevicesAreNeverOpened) {
  picture("a.png", 1);
  ASSERT_EQ(::mkfifo((folder_ / "b.png").c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/zero", folder_ / "c.png");
  const Hardware rig = open();
  EXPECT_EQ(rig.lens->info().stops.size(), 1u);
  EXPECT_EQ(findings_of<SkippedFiles>(rig).at(0).kinds.size(), 2u);
  for (const char* name : {"b.png", "c.png"}) {
    expect_error(ErrorCode::bad_data, [&] { open_hardware("replay:" + (folder_ / name).string()); },
                 {"not opened"});
  }
  manifest("file,position\na.png,0\nb.png,1\n");
  expect_refused(ErrorCode::bad_data, {"manifest.csv line 3", "pipe"});
  std::filesystem::rename(folder_ / "b.png", folder_ / "manifest.csv");
  expect_refused(ErrorCode::bad_data, {"manifest.csv is a pipe"});
}

TEST_F(Replay, PicturesOfOnePositionTakeTurns) {
  for (std::uint8_t i = 0; i < 5; ++i) picture(std::to_string(i) + ".png", i);
  manifest("file,position\n0.png,7\n1.png,8\n2.png,7\n3.png,8\n4.png,9\n");
  Hardware rig = open();
  EXPECT_EQ(rig.lens->info().stops, (std::vector<double>{7, 8, 9}));
  EXPECT_EQ(rig.lens->info().resolution, 1);
  rig.lens->move_to(8);
  EXPECT_EQ(rig.camera->recorded_here(), 2);
  EXPECT_EQ(grey(rig), 1u);
  EXPECT_EQ(grey(rig), 3u);
  EXPECT_EQ(grey(rig), 1u);
  rig.lens->move_to(9);
  EXPECT_EQ(rig.camera->recorded_here(), 1);
  const auto repeated = findings_of<RepeatedPictures>(rig);
  ASSERT_EQ(repeated.size(), 1u);
  EXPECT_EQ(repeated[0].pictures, 5u);
  EXPECT_EQ(repeated[0].positions, 3u);
}

TEST_F(Replay, OneColourCanBePlayedAndOneThatDrownsIsTold) {
  std::string blue = "P6 8 8 255\n";
  for (int i = 0; i < 64; ++i) blue += {0, 0, static_cast<char>(i)};
  write_file(folder_ / "1.ppm", blue);
  const Hardware rig = open();
  const auto drowned = findings_of<DrownedColour>(rig);
  ASSERT_EQ(drowned.size(), 1u);
  EXPECT_EQ(drowned[0].colour, 'b');
  Hardware chosen = open_hardware("replay:" + folder_.path().string() + ",channel=b");
  EXPECT_EQ(chosen.camera->grab(1s).value().at(7, 7), 63u);
  EXPECT_TRUE(findings_of<DrownedColour>(chosen).empty());
  expect_error(ErrorCode::bad_argument,
               [&] { open_hardware("replay:" + folder_.path().string() + ",channel=2"); },
               {"no channels", "channel=r, g or b"});
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
