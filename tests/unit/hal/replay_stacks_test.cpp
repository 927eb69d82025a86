// SPDX-License-Identifier: Apache-2.0
// Replays of TIFFs with many pages: their channels, times and damage.
#include "tests/unit/hal/replay_fixture.hpp"
#include "tests/unit/pictures/raw_tiff.hpp"

namespace fathom::test {
namespace {

/// A TIFF of plain 4 x 2 pages, the grey of each being its number.
std::string numbered_tiff(std::size_t pages, const std::string& description) {
  std::vector<RawPage> all;
  for (std::size_t i = 0; i < pages; ++i) all.push_back({.pixels = std::string(8, char(i))});
  all[0].description = description;
  return raw_tiff(all);
}

TEST_F(Replay, ChannelsAndTimesAreChosen) {
  const std::string path = (folder_ / "s.tif").string();
  write_file(path, numbered_tiff(24,
                                 "ImageJ=1.5\nimages=24\nchannels=2\nslices=4\nframes=3\n"
                                 "unit=um\nspacing=0.3\n"));
  expect_error(ErrorCode::bad_argument, [&] { open_hardware("replay:" + path); },
               {"2 channels", "channel=", "3 times", "time=", "s.tif,channel=0,time=0"});
  expect_error(ErrorCode::bad_argument, [&] { open_hardware("replay:" + path + ",channel=1"); },
               {"3 times"});
  expect_error(ErrorCode::bad_argument,
               [&] { open_hardware("replay:" + path + ",channel=2,time=0"); },
               {"no channel \"2\"", "0 to 1"});
  Hardware rig = open_hardware("replay:" + path + ",channel=1,time=2");
  const LensInfo info = rig.lens->info();
  EXPECT_EQ(info.unit, "um");
  EXPECT_EQ(info.stops, (std::vector<double>{0, 0.3, 0.6, 0.9}));
  EXPECT_EQ(info.stop_names[1], "s.tif page 19 (z 1)");
  rig.lens->move_to(0.9);
  EXPECT_EQ(grey(rig), (2u * 4 + 3) * 2 + 1);
  const auto chosen = findings_of<ChosenPlanes>(rig);
  ASSERT_EQ(chosen.size(), 1u);
  EXPECT_EQ(chosen[0].planes, 4u);
}

TEST_F(Replay, ATravelThatWasRecordedAsAFilmIsPlayed) {
  const std::string path = (folder_ / "s.tif").string();
  write_file(path, numbered_tiff(5, "ImageJ=1.5\nimages=5\nframes=5\n"));
  Hardware rig = open_hardware("replay:" + path);
  EXPECT_EQ(rig.lens->info().unit, "frames");
  EXPECT_EQ(rig.lens->info().stops.size(), 5u);
  expect_error(ErrorCode::bad_argument, [&] { open_hardware("replay:" + path + ",time=9"); },
               {"no time 9"});
}

TEST_F(Replay, OmeFilesOfOneRecordingAreJoined) {
  const auto document = [](int own, const char* name) {
    return "<OME><Image><Pixels DimensionOrder=\"XYZCT\" SizeZ=\"3\" SizeC=\"2\" SizeT=\"1\">"
           "<Channel Name=\"red\"/><Channel Name=\"far\"/><TiffData IFD=\"0\" FirstC=\"" +
           std::to_string(own) + "\" PlaneCount=\"3\"><UUID FileName=\"" + name +
           "\"/></TiffData><TiffData FirstC=\"" + std::to_string(1 - own) +
           "\" IFD=\"0\" PlaneCount=\"3\"><UUID FileName=\"other\"/></TiffData>"
           "</Pixels></Image></OME>";
  };
  write_file(folder_ / "a.tif", numbered_tiff(3, document(0, "a.tif")));
  write_file(folder_ / "b.tif", numbered_tiff(3, document(1, "b.tif")));
  const std::string path = folder_.path().string();
  expect_error(ErrorCode::bad_argument, [&] { open_hardware("replay:" + path); },
               {"2 channels", "1 (far)"});
  const Hardware rig = open_hardware("replay:" + path + ",channel=far");
  EXPECT_EQ(rig.lens->info().stop_names.at(2), "b.tif page 2 (z 2)");
  expect_error(ErrorCode::bad_data, [&] { open_hardware("replay:" + path + "/a.tif,channel=far"); },
               {"other files"});
}

TEST_F(Replay, DamagedPagesAreLeftOutAndTold) {
  const std::string path = (folder_ / "s.tif").string();
  const std::string whole = numbered_tiff(4, "");
  write_file(path, whole.substr(0, whole.size() - 2));
  const Hardware rig = open_hardware("replay:" + path);
  EXPECT_EQ(rig.lens->info().stops.size(), 3u);
  const auto damaged = findings_of<DamagedPages>(rig);
  ASSERT_EQ(damaged.size(), 1u);
  EXPECT_EQ(damaged[0].first, 3u);
  EXPECT_EQ(damaged[0].whole, 3u);
}

TEST_F(Replay, PlanesThatAreMissingAreSaidOnce) {
  const std::string path = (folder_ / "s.tif").string();
  RawPage page{.pixels = std::string(8 * 9, 'x'),
               .description = "ImageJ=1.5\nimages=9\nslices=9\n"};
  page.fields[279] = 8;
  const std::string whole = raw_tiff({page});
  write_file(path, whole.substr(0, whole.size() - 8 * 4 - 3));
  const Hardware rig = open_hardware("replay:" + path);
  EXPECT_EQ(rig.lens->info().stops.size(), 4u);
  EXPECT_TRUE(findings_of<DamagedPages>(rig).empty());
  const auto chosen = findings_of<ChosenPlanes>(rig);
  ASSERT_EQ(chosen.size(), 1u);
  EXPECT_EQ(chosen[0].planes, 4u);
  EXPECT_EQ(chosen[0].missing, 5u);
  EXPECT_NE(chosen[0].why.find("page 4: strip 1"), std::string::npos) << chosen[0].why;
}

TEST_F(Replay, AdviceForAFolderNamesTheFolder) {
  const std::string description = "ImageJ=1.5\nimages=2\nchannels=2\n";
  for (const char* name : {"a1.tif", "a2.tif"})
    write_file(folder_ / name, numbered_tiff(2, description));
  const std::string advice = "replay:" + folder_.path().string() + ",channel=0";
  expect_refused(ErrorCode::bad_argument, {"2 channels", advice.c_str()});
  EXPECT_EQ(open_hardware(advice).lens->info().stops.size(), 2u);
}

TEST_F(Replay, AnOmeDescriptionThatIsCutOffIsTold) {
  write_file(folder_ / "s.tif", numbered_tiff(3, "<OME><Image><Pixels SizeZ=\"3\" SizeC"));
  const Hardware rig = open();
  EXPECT_EQ(rig.lens->info().stops.size(), 3u);
  EXPECT_EQ(findings_of<DamagedDescription>(rig).at(0).file, "s.tif");
}

}  // namespace
}  // namespace fathom::test
