// SPDX-License-Identifier: Apache-2.0
// sweep, focus, calibrate, range, capture and rerun on the simulated rig, as a user types them.
#include <cmath>

#include "pictures/picture.hpp"
#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

using Sweep = Program;
using FocusVerb = Program;
using Calibrate = Program;
using Capture = Program;
using RangeVerb = Program;
using CompareSearches = Program;
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

TEST_F(Sweep, DrawsItsCurve) {
  const Outcome drawn =
      fathom("sweep --rig sim:distance=1500 --from 900 --to 1000 --step 20 --plot -");
  EXPECT_NE(drawn.out.find("lens position (steps)"), std::string::npos);
  ASSERT_EQ(fathom("sweep --rig sim --from 700 --to 800 --step 20 --plot curve.svg").status, 0);
  const std::string svg = contents(path("curve.svg"));
  EXPECT_NE(svg.find("<svg"), std::string::npos);
  EXPECT_NE(svg.find("lens position (steps)"), std::string::npos);
  EXPECT_NE(svg.find("fft:64:hann"), std::string::npos);
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
    EXPECT_EQ(result.at("evaluations"), lines.size() - 1);
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
  const auto printed = outcome.lines().back();
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

TEST_F(RangeVerb, FollowsATargetThatMoves) {
  ASSERT_EQ(fathom("calibrate --rig sim --distances 1400,1700,2000,2300,2600 -o cal.json").status,
            0);
  const Outcome outcome = fathom(
      "range --rig sim:distance=1500,speed=2 --calibration cal.json --continuous --count 5 --json "
      "-o track.json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 5u);
  for (std::size_t i = 2; i < lines.size(); ++i) {
    EXPECT_LE(lines[i].at("evaluations"), 9);
    EXPECT_GT(lines[i].at("distance_mm"), lines[i - 1].at("distance_mm"));
  }
  EXPECT_EQ(fathom("rerun track.json").status, 0);
  EXPECT_EQ(fathom("range --rig sim --calibration cal.json --count 3").status, 2);
}

TEST_F(Calibrate, ThenRangeMeasuresADistance) {
  const Outcome fitted = fathom(
      "calibrate --rig sim --distances 1400,1600,1800,2000,2200,2400,2600 --json -o cal.json "
      "--run c.json");
  ASSERT_EQ(fitted.status, 0) << fitted.err;
  EXPECT_EQ(fitted.lines().size(), 8u);
  EXPECT_GE(fitted.lines().back().at("r_squared"), 0.998);

  const Outcome ranged =
      fathom("range --rig sim:distance=1900 --calibration cal.json --json -o r.json");
  ASSERT_EQ(ranged.status, 0) << ranged.err;
  const auto result = ranged.lines().back();
  EXPECT_EQ(result.size(), 8u);
  ASSERT_EQ(result.at("foci").size(), 1u);
  EXPECT_EQ(result.at("foci")[0].at("evaluations"), result.at("evaluations"));
  EXPECT_EQ(result.at("result"), "focused");
  EXPECT_NEAR(result.at("distance_mm"), 1900, 0.005 * 1900);
  EXPECT_GT(result.at("sigma_mm"), 0);
  EXPECT_LT(result.at("sigma_mm"), 0.01 * 1900);
  EXPECT_GT(result.at("evaluations"), 7);
  for (const char* file : {"c.json", "r.json"}) {
    const Outcome again = fathom(std::string("rerun ") + file);
    EXPECT_EQ(again.status, 0) << again.err;
  }

  const Outcome repeated =
      fathom("range --rig sim:distance=1900 --calibration cal.json --repeat 4 --json");
  EXPECT_LT(repeated.lines().back().at("sigma_mm"), result.at("sigma_mm"));

  const Outcome blank = fathom("range --rig sim:target=blank --calibration cal.json --json");
  EXPECT_EQ(blank.status, 3);
  EXPECT_EQ(blank.lines().back().at("result"), "no-focus");
  EXPECT_TRUE(blank.lines().back().at("distance_mm").is_null());
}

TEST_F(Calibrate, RefusesToRangeOutsideUnlessToldTo) {
  write("points.csv", "position,distance_mm\n1028,1400\n905,1571\n810,1743\n731,1914\n");
  ASSERT_EQ(fathom("calibrate --from points.csv -o cal.json").status, 0);
  const std::string range = "range --rig sim:distance=2500 --calibration cal.json -o kept.json";
  const Outcome refused = fathom(range);
  EXPECT_EQ(refused.status, 1);
  EXPECT_NE(refused.err.find("--extrapolate"), std::string::npos);
  EXPECT_EQ(fathom("rerun kept.json").status, 0) << "the measurement itself must not be lost";
  EXPECT_EQ(fathom(range + " --extrapolate").status, 0);
}

TEST_F(Calibrate, WarnsWhenRigMetricOrWindowIsAnother) {
  ASSERT_EQ(fathom("calibrate --rig sim --distances 1400,1900,2600 -o cal.json").status, 0);
  const std::string range = "range --calibration cal.json --json --rig sim:distance=1700";
  EXPECT_EQ(fathom(range).err.find("calibration was made"), std::string::npos);
  const auto expect_warning = [&](const std::string& more, const std::vector<std::string>& words) {
    const Outcome other = fathom(range + more);
    EXPECT_EQ(other.status, 0) << other.err;
    for (const std::string& word : words) {
      EXPECT_NE(other.err.find(word), std::string::npos) << more << ": " << other.err;
    }
  };
  expect_warning(" --metric walsh-paley", {"metric fft:64:hann", "use --metric fft:64:hann"});
  expect_warning(" --window 100,88,64", {"window 96,88,64", "100,88,64", "use --window 96,88,64"});
  expect_warning(" --window 96,88,32 --metric fft:32", {"window 96,88,64", "96,88,32"});
  expect_warning(",backlash=8", {"made with rig", "calibrate this rig"});
}

TEST_F(Calibrate, RefusesPositionsInAnotherUnit) {
  ASSERT_EQ(fathom("calibrate --rig sim --distances 1400,1900,2600 -o cal.json").status, 0);
  std::string json = contents(path("cal.json"));
  const std::string unit = "\"unit\": \"steps\"";
  ASSERT_NE(json.find(unit), std::string::npos);
  write("mm.json", json.replace(json.find(unit), unit.size(), "\"unit\": \"mm\""));
  expect_refusal("range --rig sim --calibration mm.json", 2, {"mm", "steps", "calibrate"});
}

/// Points of the thesis' lens counted from its near end, one of them bad.
constexpr const char* kReversed =
    "position,distance_mm\n972.4,1400\n1080.9,1550\n1168.1,1700\n1241.5,1850\n1345.3,2000\n"
    "1370.4,2200\n1425.9,2400\n1472.3,2600\n";

TEST_F(Calibrate, ChoosesAModelAndLeavesAnOutlierOut) {
  write("points.csv", kReversed);
  const Outcome outcome =
      fathom("calibrate --from points.csv --model auto -o cal.json --plot cal.svg");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* word : {"thin-lens: it predicts", "power", "left out", "95 %", "7 of 8 points",
                           "focal_length_mm = ", "CV error"}) {
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word << " not in\n" << outcome.out;
  }
  EXPECT_NE(outcome.err.find("left out as an outlier: 2000 mm at position 1345.3"),
            std::string::npos)
      << outcome.err;
  const std::string svg = contents(path("cal.svg"));
  for (const char* word : {"<svg", "95 % prediction interval", "left out as an outlier",
                           "measured - curve (mm)", "thin-lens"}) {
    EXPECT_NE(svg.find(word), std::string::npos) << word;
  }
  const auto lines = fathom("calibrate --from points.csv --model auto --json -o cal.json").lines();
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].at("model"), "thin-lens");
  EXPECT_GT(lines[0].at("cv_error_power"), lines[0].at("cv_error_thin-lens"));
  EXPECT_NEAR(lines[1].at("focal_length_mm"), 135, 20);
  EXPECT_EQ(lines[1].at("left_out"), 1);
}

TEST_F(Calibrate, FitsEveryModelOnARig) {
  for (const std::string model : {"power", "thin-lens", "auto"}) {
    const Outcome fitted = fathom(
        "calibrate --rig sim --distances 1400,1600,1900,2200,2600 --json -o cal.json "
        "--run c.json --model " +
        model);
    ASSERT_EQ(fitted.status, 0) << fitted.err;
    const Outcome ranged =
        fathom("range --rig sim:distance=1750 --calibration cal.json --json -o r.json");
    EXPECT_NEAR(ranged.lines().back().at("distance_mm"), 1750, 12) << model;
    for (const char* file : {"c.json", "r.json"}) {
      const Outcome again = fathom(std::string("rerun ") + file);
      EXPECT_EQ(again.status, 0) << model << again.err;
    }
  }
}

TEST_F(Calibrate, DrawsItsResidualsInTheTerminal) {
  write("points.csv", kReversed);
  const Outcome drawn =
      fathom("calibrate --from points.csv --model thin-lens -o cal.json --plot -");
  EXPECT_NE(drawn.out.find("residual of the position"), std::string::npos) << drawn.out;
}

TEST_F(Calibrate, RefusesWhatItCannotFitBeforeMeasuring) {
  expect_refusal("calibrate --rig sim --distances 1400,1900 --model thin-lens -o c.json", 2,
                 {"3 distances"});
  expect_refusal("calibrate --rig sim --distances 1400,1900 --model auto -o c.json", 2,
                 {"3 distances"});
  expect_refusal("calibrate --rig sim --distances 1400,1900 --model cubic -o c.json", 2,
                 {"cubic", "thin-lens"});
  expect_refusal("calibrate --rig sim --distances 1400,1900 --plot cal.bmp -o c.json", 2,
                 {"cal.bmp", ".svg"});
  write("few.csv", "position,distance_mm\n700,1990\n600,2300\n");
  expect_refusal("calibrate --from few.csv --model thin-lens -o c.json", 2, {"3 parameters"});
}

TEST_F(Capture, MakesAStackThatReplaysToTheSameScores) {
  ASSERT_EQ(fathom("capture --rig sim:distance=1500 --from 900 --to 1000 --step 4 -o stack").status,
            0);
  const auto live =
      fathom("sweep --rig sim:distance=1500 --from 900 --to 1000 --step 4 --json").lines();
  const auto replayed = fathom("sweep --rig replay:stack --json --step 4").lines();
  ASSERT_EQ(replayed.size(), live.size());
  for (std::size_t i = 0; i < live.size(); ++i) EXPECT_EQ(replayed[i], live[i]);
  const Outcome focus = fathom("focus --rig replay:stack --json");
  EXPECT_EQ(focus.status, 0) << focus.err;
  EXPECT_NEAR(focus.lines().back().at("position"), position_of(1500), 8);
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

TEST_F(Rigs, HomeSendsTheLensToItsStop) {
  const Outcome outcome = fathom("rigs home sim:start=500");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("stands at 0 steps"), std::string::npos) << outcome.out;
  expect_refusal("rigs home sim --at 3", 1, {"knows by itself"});
  expect_refusal("rigs", 2, {"subcommand"});
}

}  // namespace
}  // namespace fathom::test
