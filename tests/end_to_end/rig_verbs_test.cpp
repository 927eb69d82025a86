// SPDX-License-Identifier: Apache-2.0
// sweep, focus, capture, rerun and rigs on the simulated rig, as a user types them.
#include <cmath>

#include "pictures/picture.hpp"
#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

using Sweep = Program;
using FocusVerb = Program;
using Capture = Program;
using CompareSearches = Program;
using CompareMetrics = Program;
using Rigs = Program;

/// Where the thesis rig focuses a distance: steps of an extension that grows evenly (thesis.md).
double position_of(double distance_mm) {
  constexpr double f = 135, nearest = 1219;
  const double extension = f * f / (distance_mm - f);
  return 1200 * extension / (f * f / (nearest - f));
}

TEST_F(Sweep, ScoresEveryPosition) {
  const Outcome outcome =
      fathom("sweep --rig sim:distance=1500 --from 900 --to 1000 --step 5 --json -o run.json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 21u);
  double best = 0, best_position = 0;
  for (const auto& line : lines) {
    EXPECT_EQ(line.size(), 2u);
    if (line.at("score") > best) best = line.at("score"), best_position = line.at("position");
  }
  EXPECT_NEAR(best_position, position_of(1500), 8);
  EXPECT_EQ(fathom("rerun run.json --json").status, 0);
}

TEST_F(Sweep, ScoresFramesOfOneTravel) {
  const std::string range = "sweep --rig sim:distance=1500 --from 900 --to 1000 --json -o ";
  const Outcome moving = fathom(range + "moving.json --moving");
  ASSERT_EQ(moving.status, 0) << moving.err;
  auto lines = moving.lines();
  const auto journey = lines.back();
  lines.pop_back();
  EXPECT_EQ(journey.at("moving"), true);
  EXPECT_EQ(journey.at("frames"), lines.size());
  EXPECT_GT(lines.size(), 100u) << "30 a second, at 25 steps a second";
  double best = 0, best_position = 0;
  for (const auto& line : lines) {
    EXPECT_LE(line.at("smear"), 2);
    if (line.at("score") > best) best = line.at("score"), best_position = line.at("position");
  }
  EXPECT_NEAR(best_position, position_of(1500), 8);
  EXPECT_EQ(fathom("rerun moving.json --json").status, 0);
}

TEST_F(Sweep, DrawsItsCurve) {
  const Outcome drawn =
      fathom("sweep --rig sim:distance=1500 --from 900 --to 1000 --step 20 --plot -");
  EXPECT_NE(drawn.out.find("lens position (steps)"), std::string::npos);
  ASSERT_EQ(fathom("sweep --rig sim --from 700 --to 800 --step 20 --plot curve.svg").status, 0);
  const std::string svg = contents(path("curve.svg"));
  EXPECT_NE(svg.find("<svg"), std::string::npos);
  EXPECT_NE(svg.find("lens position (steps)"), std::string::npos);
  EXPECT_NE(svg.find("walsh-sequency:64"), std::string::npos);
}

TEST_F(FocusVerb, FindsTheTargetOverTheWholeTravel) {
  for (const char* metric :
       {"fft", "walsh-sequency", "walsh-paley", "fft:64:hann:power:band=0-0.25"}) {
    const Outcome outcome =
        fathom("focus --rig sim:distance=1700 --json --metric " + std::string(metric));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto lines = outcome.lines();
    const auto& result = lines.back();
    EXPECT_EQ(result.at("result"), "focused");
    EXPECT_NEAR(result.at("position"), position_of(1700), 1) << metric;
    EXPECT_EQ(result.at("nearest"), std::round(result.at("position").get<double>()));
    EXPECT_LE(result.at("evaluations"), 20) << metric;
    EXPECT_GT(result.at("confidence"), 0.8) << metric;
    // The second looks are measured too.
    EXPECT_EQ(result.at("evaluations").get<std::size_t>() + result.at("second_looks").size(),
              lines.size() - 1);
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
      EXPECT_EQ(lines[i].at("loop"), i + 1);
      EXPECT_TRUE(lines[i].contains("position") && lines[i].contains("score"));
    }
  }
}

TEST_F(FocusVerb, SearchesABracketInSevenToElevenEvaluations) {
  const int peak = static_cast<int>(position_of(1500));
  const std::string bracket =
      std::to_string(peak - 70) + "," + std::to_string(peak - 10) + "," + std::to_string(peak + 90);
  const Outcome outcome = fathom(
      "focus --rig sim:distance=1500 --search golden --peak evaluated --json --bracket " + bracket);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto result = outcome.lines().back();
  EXPECT_NEAR(result.at("position"), peak, 8);
  EXPECT_GE(result.at("evaluations"), 7);
  EXPECT_LE(result.at("evaluations"), 11);
}

TEST_F(FocusVerb, ABlankCardHasNoFocus) {
  for (int seed = 1; seed <= 12; ++seed) {
    const Outcome outcome =
        fathom("focus --rig sim:target=blank,seed=" + std::to_string(seed) + " --json");
    EXPECT_EQ(outcome.status, 3) << seed;
    EXPECT_EQ(outcome.lines().back().at("result"), "no-focus") << seed;
    EXPECT_FALSE(outcome.lines().back().contains("distance_mm"));
  }
}

// Few coefficients scatter wildly, and their tail is long: still no focus where there is none.
TEST_F(FocusVerb, ABlankCardHasNoFocusForTheNoisiestMetrics) {
  for (const char* metric : {"walsh-sequency:power:band=0-0.1 --window 80,80,8",
                             "fft:none:power:band=0.68-0.71 --window 80,80,8",
                             "fft:none:power:band=0-0.02 --window 80,80,64",
                             "walsh-sequency:tukey=1:power:band=0-0.1 --window 80,80,8"}) {
    for (int seed = 1; seed <= 6; ++seed) {
      const Outcome outcome =
          fathom("focus --json --rig sim:target=blank,seed=" + std::to_string(seed) + " --metric " +
                 metric);
      EXPECT_EQ(outcome.lines().back().at("result"), "no-focus") << metric << " seed " << seed;
    }
  }
}

TEST_F(FocusVerb, SaysAtLimitWhenTheFocusLiesBeyondTheSearch) {
  const Outcome outcome = fathom("focus --rig sim:distance=1500 --from 0 --to 940 --json");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(outcome.lines().back().at("result"), "at-limit");
}

TEST_F(FocusVerb, TheSameSeedGivesTheSameRun) {
  const std::string one = fathom("focus --rig sim:seed=7 --json").out;
  EXPECT_EQ(fathom("focus --rig sim:seed=7 --json").out, one);
  EXPECT_NE(fathom("focus --rig sim:seed=8 --json").out, one);
}

TEST_F(FocusVerb, KeepsItsRunByDefault) {
  const Outcome outcome = fathom("focus --rig sim");
  const std::size_t at = outcome.out.find("run saved to ");
  ASSERT_NE(at, std::string::npos) << outcome.out;
  std::string file = outcome.out.substr(at + 13);
  file.resize(file.find('\n'));
  EXPECT_EQ(file.rfind(path("state/fathom/runs"), 0), 0u) << file;
  const Outcome again = fathom("rerun " + file);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.err.find("same answer"), std::string::npos);
}

/// One form of a focus: printed, kept and computed again.
TEST_F(FocusVerb, PrintsTheFocusThatItsRunFileKeeps) {
  const Outcome outcome =
      fathom("focus --rig sim:target=seedling,distance=1800 --json -o run.json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  auto printed = outcome.lines().back();
  // What the run cost is its own, not the focus'.
  EXPECT_GE(printed.at("frames"), printed.at("evaluations"));
  EXPECT_EQ(printed.at("moving"), false);
  printed.erase("moving");
  for (const char* const cost : {"travel", "rig_seconds", "frames"}) {
    EXPECT_GT(printed.at(cost), 0) << cost;
    printed.erase(cost);
  }
  const auto file = nlohmann::json::parse(contents(path("run.json")));
  EXPECT_EQ(file.at("format"), "fathom-run");
  EXPECT_EQ(printed, file.at("runs").at(0).at("focus"));
  EXPECT_EQ(printed.at("trace").size(), printed.at("evaluations"));
  EXPECT_EQ(printed.at("peaks").size(), printed.at("lobes").size());
  EXPECT_GT(printed.at("floor"), 0);
  EXPECT_EQ(fathom("rerun run.json --json").lines().back(), printed);
}

TEST_F(CompareSearches, HillIsTrappedWhereAutoIsNot) {
  const Outcome outcome = fathom(
      "compare-searches --searches auto,golden,hill --targets usaf --distances 1800 "
      "--noise 1 --starts 0,300 --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 5u);  // golden in three ways
  for (const auto& line : lines) {
    EXPECT_EQ(line.at("runs"), 2);
    EXPECT_EQ(line.at("wrong"), 0) << line;
    if (line.at("method") == "auto") {
      EXPECT_EQ(line.at("right"), 2);
      EXPECT_LE(line.at("evaluations_most"), 20);
    }
    if (line.at("method") == "hill") {
      EXPECT_EQ(line.at("trapped"), 2);
    }
  }
}

TEST_F(CompareSearches, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(fathom("compare-searches --searches simplex").status, 2);
  EXPECT_EQ(fathom("compare-searches --targets pear --searches auto").status, 2);
}

TEST_F(CompareMetrics, AgreeOnASceneAndOnItsPictures) {
  const std::string scene = "--rig sim:target=usaf,distance=1500 --from 840 --to 1060 --step 10";
  const std::string metrics =
      " --metrics fft,walsh-sequency,dct:entropy:band=0-0.25,tenengrad,spectral";
  const Outcome live = fathom("compare-metrics " + scene + metrics + " --json --plot all.svg");
  ASSERT_EQ(live.status, 0) << live.err;
  ASSERT_EQ(fathom("capture " + scene + " -o stack").status, 0);
  const Outcome replayed = fathom("compare-metrics stack" + metrics + " --json");
  ASSERT_EQ(replayed.status, 0) << replayed.err;
  for (const Outcome* outcome : {&live, &replayed}) {
    const auto lines = outcome->lines();
    ASSERT_EQ(lines.size(), 6u);
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_NEAR(lines[i].at("peak"), position_of(1500), 2) << lines[i];
      EXPECT_TRUE(lines[i].at("agrees")) << lines[i];
      EXPECT_GE(lines[i].at("stands_noise"), 2) << lines[i];
    }
    EXPECT_NEAR(lines[5].at("consensus"), position_of(1500), 2);
    EXPECT_TRUE(lines[5].at("recommended").is_string());
  }
  const std::string svg = contents(path("all.svg"));
  EXPECT_NE(svg.find("dct:64:entropy:band=0-0.25, stands"), std::string::npos);
  EXPECT_NE(svg.find("consensus"), std::string::npos);
  const Outcome table = fathom("compare-metrics stack --window 96,88,32" + metrics);
  EXPECT_NE(table.out.find("recommended: "), std::string::npos);
  EXPECT_NE(table.out.find("dct:32:entropy:band=0-0.25"), std::string::npos);
}

TEST_F(CompareMetrics, RecommendNoneWhereThereIsNoFocus) {
  const Outcome blank = fathom(
      "compare-metrics --rig sim:target=blank,distance=1500 --step 40 --metrics fft,tenengrad "
      "--json");
  EXPECT_EQ(blank.status, 3) << blank.err;
  const auto result = blank.lines().back();
  EXPECT_TRUE(result.at("recommended").is_null());
  EXPECT_EQ(result.at("why"), "no_peak");
  const Outcome beyond = fathom(
      "compare-metrics --rig sim:distance=1500 --from 600 --to 900 --step 20 --metrics "
      "fft,tenengrad");
  EXPECT_EQ(beyond.status, 3) << beyond.err;
  EXPECT_NE(beyond.out.find("recommended: none, because the curves rise to an end"),
            std::string::npos);
}

TEST_F(CompareMetrics, RefuseWhatIsNoComparison) {
  expect_refusal("compare-metrics", 2, {"a stack", "--rig"});
  expect_refusal("compare-metrics stack --rig sim", 2, {"one of them"});
  expect_refusal("compare-metrics --rig sim --from 900 --to 920 --step 20", 2,
                 {"5 lens positions", "there are 2"});
  expect_refusal("compare-metrics --rig sim --metrics fft:32", 2, {"leave N out"});
  expect_refusal("compare-metrics --rig sim --metrics fft:rings=4", 2, {"4 numbers"});
  expect_refusal("compare-metrics --rig sim --window 96,88,8 --metrics spectral", 2,
                 {"8 x 8", "larger --window"});
  expect_refusal("compare-metrics --rig sim --plot curves.bmp", 2, {".svg"});
}

TEST_F(Capture, MakesAStackThatReplaysToTheSameScores) {
  ASSERT_EQ(fathom("capture --rig sim:distance=1500 --from 900 --to 1000 --step 4 -o stack").status,
            0);
  const auto live =
      fathom("sweep --rig sim:distance=1500 --from 900 --to 1000 --step 4 --json").lines();
  const auto replayed = fathom("sweep --rig replay:stack --json --step 4").lines();
  ASSERT_EQ(replayed.size(), live.size());
  for (std::size_t i = 0; i < live.size(); ++i) {
    EXPECT_EQ(replayed[i].at("position"), live[i].at("position"));
    EXPECT_EQ(replayed[i].at("score"), live[i].at("score"));
    EXPECT_FALSE(live[i].contains("file"));
  }
  EXPECT_EQ(replayed[3].at("file"), "frame_00003.png");
  const Outcome focus = fathom("focus --rig replay:stack --json");
  EXPECT_EQ(focus.status, 0) << focus.err;
  EXPECT_NEAR(focus.lines().back().at("position"), position_of(1500), 8);
  const std::string nearest = focus.lines().back().at("nearest_file");
  EXPECT_TRUE(std::filesystem::exists(path("stack/" + nearest)));
  EXPECT_NE(fathom("focus --rig replay:stack").out.find("nearest picture: " + nearest),
            std::string::npos);
}

TEST_F(Capture, TakesPicturesThatAreSmallerThanAWindow) {
  std::filesystem::create_directory(path("small"));
  for (const char grey : {'a', 'k', 'u'})
    write(std::string("small/") + grey + ".pgm", "P5\n20 12\n255\n" + std::string(20 * 12, grey));
  const Outcome outcome = fathom("capture --rig replay:small -o copy");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(read_picture(path("copy/frame_00001.png")).at(19, 11), 'k');
  EXPECT_TRUE(std::filesystem::exists(path("copy/manifest.csv")));
}

TEST_F(Capture, NeverWritesOverAnything) {
  write("precious.txt", "data");
  expect_refusal("capture --rig sim --from 0 --to 10 --step 5 -o .", 2, {"empty"});
}

TEST_F(Program, ARigFileOpensARig) {
  write("my-rig.toml", "# the thesis rig\ndriver = \"sim\"\ntarget = \"usaf\"\ndistance = 1700\n");
  const Outcome outcome = fathom("focus --rig my-rig.toml --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out, fathom("focus --rig sim:target=usaf,distance=1700 --json").out);
}

TEST_F(Rigs, ListNamesTheDriversThatNeedNoHardware) {
  const Outcome outcome = fathom("rigs list");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("sim"), std::string::npos);
  EXPECT_EQ(fathom("rigs list --json").status, 0);
}

TEST_F(Rigs, CheckMeasuresWhatARigIs) {
  const Outcome outcome = fathom("rigs check sim:distance=1500,start=300 --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto found = outcome.lines().back();
  EXPECT_NEAR(found.at("frames_per_s"), 30, 0.1);
  EXPECT_EQ(found.at("result"), "focused");
  EXPECT_NEAR(found.at("position"), position_of(1500), 1);
  EXPECT_LT(found.at("settled_after_ms"), 100);
  EXPECT_LT(std::abs(found.at("play_left").get<double>()), 1.5);
  EXPECT_GT(found.at("coarse"), 10);
  EXPECT_TRUE(found.at("settle_ms").is_null());  // the simulated lens cannot be told to wait less
}

TEST_F(Rigs, CheckOfABlankCardSaysWhatToDo) {
  const Outcome outcome = fathom("rigs check sim:target=blank");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_NE(outcome.out.find("30.0 a second"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("texture"), std::string::npos) << outcome.err;
}

/// An orange's dimples are too faint for some metrics.
TEST_F(Rigs, CheckTriesOtherMetricsAndWindows) {
  const std::string rig = "sim:target=orange,distance=2200,seed=3,noise=3";
  EXPECT_EQ(fathom("focus --metric fft --rig " + rig).status, 3);
  const Outcome outcome = fathom("rigs check " + rig + " --metric fft --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto found = outcome.lines().back();
  EXPECT_EQ(found.at("result"), "focused");
  const Outcome tried = fathom("focus --rig " + rig + " --json --metric " +
                               found.at("metric_tried").get<std::string>() + " --window " +
                               found.at("window_tried").get<std::string>());
  ASSERT_EQ(tried.status, 0) << tried.err;
  EXPECT_NEAR(tried.lines().back().at("position"), found.at("position"),
              4 * found.at("sigma").get<double>());
}

TEST_F(Rigs, LightThatIsWantingOrTooMuchIsSaid) {
  const Outcome dark = fathom("focus --rig sim:exposure_ms=1");
  EXPECT_NE(dark.err.find("dark"), std::string::npos) << dark.err;
  EXPECT_NE(dark.err.find("exposure_ms (now 1)"), std::string::npos) << dark.err;
  const Outcome bright = fathom("focus --rig sim:exposure_ms=400");
  EXPECT_NE(bright.err.find("too bright"), std::string::npos) << bright.err;
  EXPECT_EQ(fathom("focus --rig sim").err.find("dark"), std::string::npos);
}

TEST_F(Rigs, HomeSendsTheLensToItsStop) {
  const Outcome outcome = fathom("rigs home sim:start=500");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("stands at 0 steps"), std::string::npos) << outcome.out;
  expect_refusal("rigs home sim --at 3", 1, {"knows by itself"});
  expect_refusal("rigs", 2, {"subcommand"});
}

}  // namespace
}  // namespace fathom::test
