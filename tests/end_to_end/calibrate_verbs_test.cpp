// SPDX-License-Identifier: Apache-2.0
// calibrate and range on the simulated rig, as a user types them.
#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

using Calibrate = Program;
using RangeVerb = Program;

TEST_F(RangeVerb, FollowsATargetThatMoves) {
  ASSERT_EQ(
      fathom("calibrate --rig sim --metric fft --distances 1400,1700,2000,2300,2600 -o cal.json")
          .status,
      0);
  const Outcome outcome = fathom(
      "range --rig sim:distance=1500,speed=2 --metric fft --calibration cal.json --continuous "
      "--count 5 --json -o track.json");
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
  EXPECT_EQ(result.size(), 14u);
  EXPECT_EQ(result.at("unlikeness_sigma_mm"), 0) << "it is the same chart";
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

  // From one start a search by spectra may be lucky; a coarse one looks at the same places.
  const std::string coarse =
      "range --rig sim:distance=1900 --calibration cal.json --search coarse --json";
  const Outcome once = fathom(coarse), repeated = fathom(coarse + " --repeat 4");
  EXPECT_LT(repeated.lines().back().at("sigma_mm"), once.lines().back().at("sigma_mm"));

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
  expect_warning(" --metric walsh-paley",
                 {"metric walsh-sequency:64", "use --metric walsh-sequency:64"});
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

}  // namespace
}  // namespace fathom::test
