// SPDX-License-Identifier: Apache-2.0
// Bad input gets one line that says what, where and what to do, and loses nothing.
#include "pictures/picture.hpp"
#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

class BadInput : public Program {
 protected:
  void SetUp() override {
    write_picture(path("a.png"), Frame(256, 256, std::vector<std::uint8_t>(256 * 256, 7)));
  }
};

TEST_F(BadInput, WindowOverTheEdge) {
  expect_refusal("score a.png --window 200,200,64", 1,
                 {"64 x 64", "200,200", "256 x 256", "window 192,192,64 fits"});
  expect_refusal("score a.png --window -1,0,64", 1, {"-1,0", "window 0,0,64 fits"});
  expect_refusal("focus --rig sim --window 200,200,64", 1, {"256 x 240"});
}

TEST_F(BadInput, SideThatNoTransformTakes) {
  expect_refusal("score a.png --window 0,0,65", 2, {"65", "power of two"});
  expect_refusal("score a.png --metric fft:100", 2, {"100", "power of two"});
  expect_refusal("score a.png --metric fft:32 --window 0,0,64", 2, {"fft:32", "0,0,64"});
  expect_refusal("score a.png --window 1,2", 2, {"X,Y,N"});
}

TEST_F(BadInput, MetricThatDoesNotExist) {
  expect_refusal("score a.png --metric dst", 2, {"dst", "walsh-sequency"});
  expect_refusal("score a.png --metric walsh-paley:64:band=0-0.2", 2, {"walsh-paley", "band"});
  expect_refusal("score a.png --metric fft:64:hamming", 2, {"hamming"});
}

TEST_F(BadInput, PictureThatIsNone) {
  write("empty.png", "");
  write("text.png", "hello");
  write("half.png", contents(path("a.png")).substr(0, 90));
  std::string huge = contents(path("a.png"));
  for (int i = 16; i < 24; ++i) huge[i] = '\x7f';  // width and height of the header
  write("huge.png", huge);
  expect_refusal("score missing.png", 1, {"missing.png", "No such file"});
  expect_refusal("score empty.png", 1, {"empty.png", "empty"});
  expect_refusal("score text.png", 1, {"text.png"});
  expect_refusal("score half.png", 1, {"half.png"});
  expect_refusal("score huge.png", 1, {"huge.png"});
  expect_refusal("score .", 1, {});
  expect_refusal("score a.png --page 3", 1, {"page"});
  expect_refusal("score a.png --page x", 2, {"--page x"});
}

TEST_F(BadInput, BackendThatDoesNotExist) {
  expect_refusal("score a.png --backend abacus", 1, {"abacus", "reference"});
  expect_refusal("score a.png --backend reference:7", 1, {"reference:7", "reference:0"});
  expect_refusal("score a.png --backend cpu:", 2, {"\"cpu:\"", "write cpu or cpu:INDEX"});
  expect_refusal("score a.png --backend auto:1", 2, {"auto:1", "auto takes no index"});
  expect_refusal("bench --backend reference --backend cpu:", 2, {"\"cpu:\""});
}

TEST_F(BadInput, NumberOfThreadsThatIsNone) {
  for (const char* verb : {"score a.png", "spectrum a.png -o s.png", "focus --rig sim"}) {
    for (const char* threads : {"0", "-1", "1.5", "many", "99999999999"}) {
      expect_refusal(std::string(verb) + " --threads " + threads, 2, {"--threads", threads});
    }
  }
}

TEST_F(BadInput, GridThatIsNone) {
  for (const char* stride : {"abc", "0", "-8", "1.5", "8px", "99999999999"}) {
    expect_refusal(std::string("score a.png --grid ") + stride, 2,
                   {"--grid", stride, "whole number from 1 on"});
  }
}

TEST_F(BadInput, NumberThatIsNone) {
  for (const char* arguments :
       {"focus --rig sim --from abc", "focus --rig sim --tolerance 1x",
        "focus --rig sim --average 1.5", "sweep --rig sim --step abc", "spectrum a.png --page q"}) {
    expect_refusal(arguments, 2, {"write a number"});
  }
  expect_refusal("focus --rig sim --from abc", 2, {"--from abc"});
}

TEST_F(BadInput, StackOfDifferentSizes) {
  write_picture(path("s/1.png"), Frame(80, 80, std::vector<std::uint8_t>(80 * 80, 1)));
  write_picture(path("s/2.png"), Frame(80, 81, std::vector<std::uint8_t>(80 * 81, 2)));
  expect_refusal("focus --rig replay:s", 1, {"2.png", "80 x 81"});
}

TEST_F(BadInput, ManifestThatIsWrong) {
  write_picture(path("s/1.png"), Frame(80, 80, std::vector<std::uint8_t>(80 * 80, 1)));
  write_picture(path("s/2.png"), Frame(80, 80, std::vector<std::uint8_t>(80 * 80, 2)));
  write("s/manifest.csv", "file,position\n1.png,5\n1.png,5\n");
  expect_refusal("focus --rig replay:s", 1, {"manifest.csv line 3", "line 2"});
  write("s/manifest.csv", "file,position\n1.png,5\n2.png,far\n");
  expect_refusal("focus --rig replay:s", 1, {"manifest.csv", "far"});
  write("s/manifest.csv", "file,position\n1.png,5\n3.png,6\n");
  expect_refusal("focus --rig replay:s", 1, {"3.png"});
}

TEST_F(BadInput, RigThatDoesNotExist) {
  expect_refusal("focus --rig hubble", 2, {"hubble", "sim", "replay"});
  expect_refusal("focus --rig sim:tagret=usaf", 2, {"tagret", "target"});
  expect_refusal("focus --rig sim:target=moon", 2, {"moon", "usaf"});
  expect_refusal("focus --rig replay:nowhere", 1, {"nowhere"});
  expect_refusal("focus --rig missing.toml", 1, {"missing.toml"});
}

TEST_F(BadInput, SearchThatMakesNoSense) {
  expect_refusal("focus --rig sim --from 900 --to 100", 2, {"900", "100"});
  expect_refusal("focus --rig sim --to 5000", 1, {"5000", "1200"});
  expect_refusal("focus --rig sim --bracket 3,2,1", 2, {"A,X,B"});
  expect_refusal("focus --rig sim --tolerance 0", 2, {"tolerance"});
  expect_refusal("focus --rig sim --search dowsing", 2, {"dowsing", "golden"});
  expect_refusal("sweep --rig sim --step 0", 2, {"--step"});
  expect_refusal("sweep --rig sim --moving --average 2", 2, {"cannot be averaged"});
  expect_refusal("focus --rig sim --average 0", 2, {"--average"});
}

TEST_F(BadInput, CalibrationOnTooFewPoints) {
  write("one.csv", "position,distance_mm\n700,1990\n");
  write("words.csv", "position,distance_mm\n700,near\n");
  expect_refusal("calibrate --from one.csv -o cal.json", 2, {"2 parameters", "1 point"});
  expect_refusal("calibrate --from words.csv -o cal.json", 1, {"words.csv", "line 2", "near"});
  expect_refusal("calibrate --rig sim -o cal.json", 2, {"--distances"});
  expect_refusal("calibrate -o cal.json", 2, {"--rig"});
  expect_refusal("range --rig sim --calibration one.csv", 1, {"one.csv", "calibrate"});
  expect_refusal("range --rig sim --calibration missing.json", 1, {"missing.json"});
  write("future.json", R"({"format":"fathom-calibration","version":9})");
  expect_refusal("range --rig sim --calibration future.json", 1,
                 {"future.json", "version 9", "calibrate again"});
}

TEST_F(BadInput, PlotThatCannotBeDrawn) {
  expect_refusal("sweep --rig sim --plot curve.bmp", 2, {"curve.bmp", ".svg"});
}

TEST_F(BadInput, DecimalCommaOrNonsensePoints) {
  write("comma.csv", "position,distance_mm\n1000,5,1400\n500,2600,7\n");
  write("twice.csv", "position,position,distance_mm\n1,2,3\n");
  write("flat.csv", "position,distance_mm\n500,1500\n600,1500\n700,1500\n");
  write("wild.csv", "position,distance_mm\n1e308,1400\n1e307,1e308\n5,6\n");
  expect_refusal("calibrate --from comma.csv -o cal.json", 1, {"comma.csv line 2", "columns"});
  expect_refusal("calibrate --from twice.csv -o cal.json", 1, {"twice.csv line 1", "position"});
  write("mark.csv", "\xEF\xBB\xBFposition,distance_mm\n1028,1400\n731,1914\n527,2600\n");
  EXPECT_EQ(fathom("calibrate --from mark.csv -o cal.json").status, 0);
  for (const char* csv : {"flat.csv", "wild.csv"}) {
    const Outcome outcome = fathom(std::string("calibrate --json -o c2.json --from ") + csv);
    EXPECT_NE(outcome.err.find(outcome.status == 0 ? "poor" : "curve"), std::string::npos)
        << csv << outcome.err;
  }
}

TEST_F(BadInput, OutputThatWouldDestroyAnInput) {
  write("cal.json", "precious");
  expect_refusal("range --rig sim --calibration cal.json -o ./cal.json", 2,
                 {"cal.json", "destroy"});
  expect_refusal("calibrate --rig sim --distances 1400,2000 -o c.json --run c.json", 2, {"c.json"});
  expect_refusal("sweep --rig sim -o a.svg --plot a.svg", 2, {"a.svg"});
  expect_refusal("spectrum a.png -o a.png", 2, {"a.png"});
  EXPECT_EQ(contents(path("cal.json")), "precious");
}

TEST_F(BadInput, OutputThatCannotBeWrittenIsSaidBeforeMeasuring) {
  const Outcome folder = fathom("sweep --rig sim -o . --json");
  EXPECT_EQ(folder.status, 1);
  EXPECT_EQ(folder.out, "");
}

TEST_F(BadInput, EmptyArgument) {
  expect_refusal("score a.png --window ''", 2, {"empty"});
  expect_refusal("capture --rig sim -o ''", 2, {"empty"});
}

TEST_F(BadInput, SearchesThatWouldNeverEnd) {
  EXPECT_EQ(fathom("focus --rig sim --tolerance 1e-300", "timeout 60").status, 0);
  for (const char* name : {"1", "2", "3", "4"}) {
    write_picture(path(std::string("gap/") + name + ".png"),
                  Frame(80, 80, std::vector<std::uint8_t>(80 * 80, 9)));
  }
  write("gap/manifest.csv", "file,position\n1.png,0\n2.png,1e-9\n3.png,1200\n4.png,1e9\n");
  const Outcome outcome = fathom("focus --rig replay:gap --json", "timeout 60");
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_EQ(outcome.lines().back().at("evaluations"), 4);
}

TEST_F(BadInput, DistancesThatDetermineNothingAreRefusedBeforeMeasuring) {
  expect_refusal("calibrate --rig sim --distances 1400 -o cal.json", 2, {"distance"});
  expect_refusal("calibrate --rig sim --distances 1400,1400 -o cal.json", 2, {"distance"});
  expect_refusal("calibrate --rig sim --distances 1400,-5 -o cal.json", 2, {"-5"});
  expect_refusal("calibrate --from points.csv --plot points.csv -o cal.json", 2, {"points.csv"});
}

// Stderr that takes nothing must not turn a result into a crash.
TEST_F(BadInput, NobodyListensOnStandardError) {
  const std::string command = FATHOM_PROGRAM " score " + path("none.png") + " 2>/dev/full";
  const int raw = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(raw));
  EXPECT_EQ(WEXITSTATUS(raw), 1);
}

TEST_F(BadInput, WrongUsage) {
  expect_refusal("score a.png --metric fft:band=0.9-1", 2, {"band", "64 x 64"});
  expect_refusal("score", 2, {"--help"});

  expect_refusal("", 2, {"--help"});
  expect_refusal("measure", 2, {"measure", "focus"});
  expect_refusal("score a.png --loud", 2, {"--loud"});
  expect_refusal("focus", 2, {"--rig"});
}

// A full disk, played by a limit on the size of files: 4 KiB is less than the run file of this sweep.
TEST_F(BadInput, FullDiskLeavesTheOldRunAndPrintsTheResult) {
  const std::string sweep = "sweep --rig sim --from 0 --to 1200 --step 20 --json -o run.json";
  ASSERT_EQ(fathom(sweep).status, 0);
  const std::string before = contents(path("run.json"));
  ASSERT_GT(before.size(), 5000u);
  const Outcome full = fathom(sweep, "ulimit -f 8;");
  EXPECT_EQ(full.status, 1);
  EXPECT_NE(full.err.find("run.json"), std::string::npos) << full.err;
  EXPECT_EQ(contents(path("run.json")), before);
  EXPECT_EQ(full.lines().size(), 61u);
  EXPECT_EQ(fathom("rerun run.json").status, 0);
}

TEST_F(BadInput, ARunThatCannotBeWrittenByDefaultOnlyWarns) {
  write("state", "a file where the folder should be");
  const Outcome outcome = fathom("focus --rig sim");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.err.find("the run is lost"), std::string::npos);
  EXPECT_NE(outcome.out.find("focused"), std::string::npos);
}

TEST_F(BadInput, AChangedRunDoesNotComeToItsAnswer) {
  ASSERT_EQ(fathom("focus --rig sim -o run.json").status, 0);
  std::string text = contents(path("run.json"));
  const std::size_t at = text.find("\"position\": ", text.find("\"focus\": {"));
  text[at + 12] = text[at + 12] == '1' ? '2' : '1';
  write("run.json", text);
  expect_refusal("rerun run.json", 1, {"run.json", "does not come to the answer"});
}

// A search that takes minutes, interrupted: what was measured is kept and can still be rerun.
TEST_F(BadInput, CtrlCKeepsTheRun) {
  // Long enough for a first evaluation under sanitizers, short of the last one without. In the
  // foreground, for else timeout signals its whole group too: twice, and a second Ctrl-C kills.
  const Outcome outcome = fathom("focus --rig sim --search full --average 30 --json -o run.json",
                                 "timeout --foreground --preserve-status -s INT 6");
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("stopped on request"), std::string::npos) << outcome.err;
  const auto file = nlohmann::json::parse(contents(path("run.json")));
  EXPECT_EQ(file.at("error"), "stopped on request");
  EXPECT_GT(file.at("runs").at(0).at("evaluations").size(), 0u);
  EXPECT_FALSE(file.at("runs").at(0).contains("focus"));
  const Outcome again = fathom("rerun run.json");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.err.find("ended early"), std::string::npos) << again.err;
}

TEST_F(BadInput, PicturesThatAreAllAlikeHaveNoFocus) {
  for (const char* name : {"1", "2", "3", "4", "5"}) {
    write_picture(path(std::string("white/") + name + ".png"),
                  Frame(80, 80, std::vector<std::uint8_t>(80 * 80, 255)));
  }
  const Outcome outcome = fathom("focus --rig replay:white --json");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(outcome.lines().back().at("result"), "no-focus");
  for (const char* word : {"does the lens move", "fresh pictures", "100 % of the window"})
    EXPECT_NE(outcome.err.find(word), std::string::npos) << word << " not in " << outcome.err;
}

TEST_F(BadInput, OnePositionIsNoSearch) {
  const Outcome outcome = fathom("focus --rig sim --from 300 --to 300 --json");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_NE(outcome.err.find("one position alone"), std::string::npos) << outcome.err;
  EXPECT_GT(outcome.lines().back().at("sigma"), 0);
}

TEST_F(BadInput, APictureThatIsOverexposedIsSaid) {
  const Outcome bright = fathom("focus --rig sim:exposure_ms=100 --json -o bright.json");
  EXPECT_NE(bright.err.find("saturated"), std::string::npos) << bright.err;
  EXPECT_NE(bright.err.find("shorten the exposure"), std::string::npos) << bright.err;
  EXPECT_NE(contents(path("bright.json")).find("\"saturated\": 0."), std::string::npos);
  EXPECT_EQ(fathom("focus --rig sim --json").err.find("saturated"), std::string::npos);
}

// Exposure halved: the score falls, the confidence stays.
TEST_F(BadInput, LessLightIsNotLessConfidence) {
  const auto confidence = [&](const std::string& rig) {
    return fathom("focus --json --rig " + rig).lines().back().at("confidence").get<double>();
  };
  EXPECT_NEAR(confidence("sim:exposure_ms=8"), confidence("sim:exposure_ms=16"), 0.05);
}

}  // namespace
}  // namespace fathom::test
