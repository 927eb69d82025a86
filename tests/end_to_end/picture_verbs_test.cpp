// SPDX-License-Identifier: Apache-2.0
// devices, score and spectrum, as a user types them.
#include <sys/stat.h>

#include "pictures/picture.hpp"
#include "tests/end_to_end/program.hpp"
#include "tests/support/frames.hpp"
#include "tests/unit/pictures/raw_tiff.hpp"

namespace fathom::test {
namespace {

using Score = Program;
using Spectrum = Program;
using Devices = Program;

Frame ramp_picture(int width, int height) {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      pixels.push_back(static_cast<std::uint8_t>((3 * x + 5 * y) % 251));
  }
  return Frame(width, height, std::move(pixels));
}

TEST_F(Devices, ListTheReference) {
  const Outcome text = fathom("devices");
  EXPECT_EQ(text.status, 0);
  EXPECT_NE(text.out.find("reference:0"), std::string::npos);
  EXPECT_NE(text.out.find("takes every metric; all are fused"), std::string::npos);
  bool found = false;
  for (const auto& line : fathom("devices --json").lines()) {
    found = found || (line.at("backend") == "reference" && line.at("kind") == "cpu");
  }
  EXPECT_TRUE(found);
}

TEST_F(Score, OneWindowHasTheKeysOfTheInterface) {
  write_picture(path("a.png"), ramp_picture(200, 100));
  const Outcome outcome =
      fathom("score a.png --window 10,20,32 --metric walsh-sequency --backend reference --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].size(), 8u);
  EXPECT_EQ(lines[0].at("image"), "a.png");
  EXPECT_EQ(lines[0].at("page"), 0);
  EXPECT_EQ(lines[0].at("x"), 10);
  EXPECT_EQ(lines[0].at("y"), 20);
  EXPECT_EQ(lines[0].at("n"), 32);
  EXPECT_EQ(lines[0].at("metric"), "walsh-sequency:32");
  EXPECT_EQ(lines[0].at("backend"), "reference");
  EXPECT_GT(lines[0].at("score"), 0);
}

TEST_F(Score, DefaultsToTheCentreAndFft64) {
  write_picture(path("a.pgm"), ramp_picture(200, 100));
  const auto line = fathom("score a.pgm --json").lines().at(0);
  EXPECT_EQ(line.at("x"), 68);
  EXPECT_EQ(line.at("y"), 18);
  EXPECT_EQ(line.at("metric"), "fft:64:hann");
  EXPECT_EQ(fathom("score a.pgm --metric fft:16 --json").lines().at(0).at("n"), 16);
}

TEST_F(Score, PicturesOfOneContentScoreAlikeInEveryFormat) {
  const Frame picture = ramp_picture(120, 90);
  for (const char* name : {"a.png", "a.tif", "a.pgm"}) write_picture(path(name), picture);
  const auto lines = fathom("score a.png a.tif a.pgm --json").lines();
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].at("score"), lines[1].at("score"));
  EXPECT_EQ(lines[0].at("score"), lines[2].at("score"));
}

TEST_F(Score, AGridScoresEveryWindowAsItWouldAlone) {
  write_picture(path("a.png"), ramp_picture(100, 60));
  const auto grid = fathom("score a.png --metric walsh-paley:16 --grid 20 --json").lines();
  ASSERT_EQ(grid.size(), 5u * 3u);
  for (const auto& line : grid) {
    const auto alone = fathom("score a.png --metric walsh-paley --json --window " +
                              std::to_string(line.at("x").get<int>()) + "," +
                              std::to_string(line.at("y").get<int>()) + ",16");
    EXPECT_EQ(alone.lines().at(0).at("score"), line.at("score"));
  }
}

TEST_F(Score, AGridStartsAtTheWindowThatWasAskedFor) {
  write_picture(path("a.png"), ramp_picture(100, 60));
  const auto grid = fathom("score a.png --window 50,30,16 --grid 20 --json").lines();
  ASSERT_EQ(grid.size(), 2u);
  EXPECT_EQ(grid[0].at("x"), 50);
  EXPECT_EQ(grid[0].at("y"), 30);
  EXPECT_EQ(grid[1].at("x"), 70);
}

/// More windows than one call takes, so that what happens between two batches shows.
TEST_F(Score, AGridOfManyBatchesHasEveryRowInItsPlace) {
  write_picture(path("a.pgm"), make_frame("random", 16, 1000, 800, 7));
  const auto grid = fathom("score a.pgm --metric walsh-sequency:8 --grid 8 --json").lines();
  ASSERT_EQ(grid.size(), 125u * 100u);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    ASSERT_EQ(grid[i].at("x"), 8 * (i % 125)) << "row " << i;
    ASSERT_EQ(grid[i].at("y"), 8 * (i / 125)) << "row " << i;
  }
  for (const std::size_t i : {0, 1, 4095, 4096, 8190, 8191, 8192, 12499}) {
    const std::string window = std::to_string(8 * (i % 125)) + "," + std::to_string(8 * (i / 125));
    const auto alone =
        fathom("score a.pgm --metric walsh-sequency --json --window " + window + ",8").lines();
    EXPECT_EQ(alone.at(0), grid[i]) << "row " << i;
  }
}

TEST_F(Score, RowsAreWrittenAsTheyWereAlways) {
  write_picture(path("a \"b\".pgm"), Frame(9, 9, std::vector<std::uint8_t>(81, 3)));
  EXPECT_EQ(
      fathom("score 'a \"b\".pgm' --backend reference --metric walsh-paley --window 1,0,8 --json")
          .out,
      R"({"image":"a \"b\".pgm","page":0,"x":1,"y":0,"n":8,"metric":"walsh-paley:8",)"
      R"("backend":"reference","score":0})"
      "\n");
  EXPECT_EQ(fathom("score 'a \"b\".pgm' --metric walsh-paley --window 0,1,8").out,
            "0              a \"b\".pgm page 0 window 0,1,8 walsh-paley:8\n");
}

TEST_F(Score, NumbersSurviveTheTrip) {
  write_picture(path("a.png"), ramp_picture(100, 60));
  const std::string out = fathom("score a.png --metric fft:32 --json").out;
  const std::string digits = out.substr(out.find("\"score\":") + 8);
  EXPECT_EQ(std::stod(digits), nlohmann::json::parse(out).at("score").get<double>());
  EXPECT_GE(digits.find('}'), 18u) << digits;  // 0. and 17 digits
}

TEST_F(Score, OneBadPictureDoesNotLoseTheOthers) {
  write_picture(path("a.png"), ramp_picture(100, 80));
  write("bad.png", "not a picture");
  const Outcome outcome = fathom("score a.png bad.png a.png --json");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.lines().size(), 2u);
  EXPECT_NE(outcome.err.find("bad.png"), std::string::npos);
}

TEST_F(Score, OneBadPageDoesNotLoseTheOthers) {
  std::vector<RawPage> pages(3, {.width = 8, .height = 8, .pixels = std::string(64, 'a')});
  pages[1].fields[273] = 0;  // its strip is missing
  write("s.tif", raw_tiff(pages));
  const Outcome outcome = fathom("score s.tif --page all --json --metric fft:8");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.lines().size(), 2u);
  EXPECT_NE(outcome.err.find("s.tif page 1"), std::string::npos) << outcome.err;
}

TEST_F(Score, APageOfAStackSaysItsChannel) {
  std::vector<RawPage> pages(4, {.width = 8, .height = 8, .pixels = std::string(64, 'x')});
  pages[0].description = "ImageJ=1.5\nimages=4\nchannels=2\nslices=2\n";
  write("s.tif", raw_tiff(pages));
  const Outcome outcome = fathom("score s.tif --page all --metric walsh-paley:8");
  EXPECT_NE(outcome.out.find("s.tif page 1 (channel 1, z 0) window 0,0,8"), std::string::npos)
      << outcome.out;
  const auto lines = fathom("score s.tif --page all --metric walsh-paley:8 --json").lines();
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[2].at("channel"), 0);
  EXPECT_EQ(lines[2].at("z"), 1);
  EXPECT_FALSE(lines[2].contains("time"));
}

TEST_F(Score, APipeByNameIsRefusedAndOneThatIsGivenIsRead) {
  write_picture(path("a.pgm"), ramp_picture(80, 80));
  ASSERT_EQ(::mkfifo(path("pipe.pgm").c_str(), 0600), 0);
  expect_refusal("score pipe.pgm", 1, {"pipe.pgm is a pipe"});
  EXPECT_EQ(fathom("score /dev/fd/3 3<&0", "cat a.pgm |").status, 0);
}

TEST_F(Score, OneColourIsScoredAlone) {
  std::string pixels;
  for (int i = 0; i < 64; ++i) pixels += {0, 0, static_cast<char>(i)};
  write("blue.ppm", "P6 8 8 255\n" + pixels);
  write("grey.pgm", [] {
    std::string file = "P5 8 8 255\n";
    for (int i = 0; i < 64; ++i) file += static_cast<char>(i);
    return file;
  }());
  const auto score = [this](const std::string& what) {
    return fathom("score " + what + " --json --metric fft:8")
        .lines()
        .at(0)
        .at("score")
        .get<double>();
  };
  EXPECT_EQ(score("blue.ppm --channel b"), score("grey.pgm"));
  EXPECT_EQ(fathom("score blue.ppm --channel 2").status, 2);
}

TEST_F(Score, StopsWhenNobodyReads) {
  write_picture(path("a.png"), ramp_picture(100, 80));
  const int raw = std::system(
      (FATHOM_PROGRAM " score " + path("a.png") + " >/dev/full 2>" + path("err.txt")).c_str());
  EXPECT_EQ(WEXITSTATUS(raw), 1);
  EXPECT_NE(contents(path("err.txt")).find("standard output"), std::string::npos);
}

TEST_F(Score, SaysInOneLineThatAPipeWasClosed) {
  write_picture(path("a.png"), ramp_picture(100, 80));
  const std::string command = "{ " FATHOM_PROGRAM " score " + path("a.png") +
                              " --metric walsh-paley:8 --grid 1; echo $? >" + path("status.txt") +
                              "; } 2>" + path("err.txt") + " | head -1 >/dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(contents(path("status.txt")), "1\n");
  EXPECT_EQ(contents(path("err.txt")), "fathom: cannot write to standard output: Broken pipe\n");
}

TEST_F(Spectrum, OfAnFftHasOneMoreRowAndColumn) {
  write_picture(path("a.png"), ramp_picture(100, 80));
  ASSERT_EQ(fathom("spectrum a.png --window 8,8,64 --db -o s.png").status, 0);
  const Frame picture = read_picture(path("s.png"));
  ASSERT_EQ(picture.width_px(), 65);
  ASSERT_EQ(picture.height_px(), 65);
  EXPECT_EQ(picture.at(32, 32), 255u);  // zero frequency is the largest of any ordinary picture
  for (int i = 0; i < 65; ++i) {
    EXPECT_EQ(picture.at(i, 0), picture.at(i, 64));
    EXPECT_EQ(picture.at(0, i), picture.at(64, i));
    for (int j = 0; j < 65; ++j) EXPECT_EQ(picture.at(i, j), picture.at(64 - i, 64 - j));
  }
}

TEST_F(Spectrum, OfAWalshTransformStartsAtItsCorner) {
  write_picture(path("a.png"), ramp_picture(100, 80));
  ASSERT_EQ(fathom("spectrum a.png --window 8,8,32 --metric walsh-sequency -o s.pgm").status, 0);
  const Frame picture = read_picture(path("s.pgm"));
  EXPECT_EQ(picture.width_px(), 32);
  EXPECT_EQ(picture.at(0, 0), 255u);
}

}  // namespace
}  // namespace fathom::test
