// SPDX-License-Identifier: Apache-2.0
// The surfaces of simulated targets whose depth is known, as the program lists and aims at them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

using nlohmann::json;

class SurfaceVerbs : public Program {
 protected:
  void calibrate() {
    const Outcome made = fathom(
        "calibrate --rig sim --distances 1350,1400,1450,1500,1550,1600,1700,1800 --model thin-lens "
        "-o cal.json");
    ASSERT_EQ(made.status, 0) << made.err;
  }

  json list(const std::string& arguments) {
    const Outcome outcome = fathom("range --all --json " + arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.lines().at(0);
  }

  /// x, y, n of "window X,Y,N:" on standard error.
  static std::array<int, 3> window_of(const Outcome& outcome) {
    std::array<int, 3> window{};
    const std::size_t at = outcome.err.find("window ");
    if (at != std::string::npos) {
      std::sscanf(outcome.err.c_str() + at, "window %d,%d,%d", &window[0], &window[1], &window[2]);
    }
    return window;
  }
};

const std::string kSweep = " --calibration cal.json --from 800 --to 1100 --step 15";

TEST_F(SurfaceVerbs, ListEveryStepOfAStairTheNearestFirst) {
  calibrate();
  for (const int seed : {1, 8}) {
    const json found =
        list("--csv list.csv --rig sim:target=stair,distance=1500,seed=" + std::to_string(seed) +
             kSweep);
    EXPECT_EQ(found["order"], "nearest first");
    ASSERT_EQ(found["surfaces"].size(), 4u);
    for (int i = 0; i < 4; ++i) {
      const json& step = found["surfaces"][static_cast<std::size_t>(i)];
      const double truth = 1455 + 30 * i;
      const double sigma = step["sigma_mm"];
      EXPECT_NEAR(step["distance_mm"], truth, 3 * sigma);
      EXPECT_LT(sigma, 4);  // mm, of 30 from step to step
      EXPECT_NEAR(step["centre_x"], 31.5 + 64 * (3 - i), 8);
      // Windows of 8 px that see both sides of a cliff are left out of 64 px, and more of the farther
      // step, some of which the nearer one's blur covers.
      const int lost_px = (i < 3 ? 7 : 0) + (i > 0 ? 13 : 0);
      EXPECT_NEAR(step["area"], (64 - lost_px) / 256.0, 4 / 256.0);
    }
    // A header, and a line each.
    const std::string csv = contents(path("list.csv"));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
    EXPECT_EQ(csv.rfind("distance_mm,sigma_mm,position,", 0), 0u);
  }
}

TEST_F(SurfaceVerbs, TellAPlaneFromABallBeforeAWall) {
  calibrate();
  const json plane = list("--rig sim:target=slant,distance=1500" + kSweep);
  ASSERT_EQ(plane["surfaces"].size(), 1u);
  const json& slant = plane["surfaces"][0];
  EXPECT_NEAR(slant["distance_mm"], 1500, 3 * slant["sigma_mm"].get<double>());
  EXPECT_NEAR(slant["slope_x_mm"], 0.5, 0.03);
  EXPECT_NEAR(slant["slope_y_mm"], 0, 0.03);

  const json both = list("--rig sim:target=sphere,distance=1500" + kSweep);
  ASSERT_EQ(both["surfaces"].size(), 2u);
  // The mean of what is not the ball's steep rim, and the plane behind it.
  EXPECT_GT(both["surfaces"][0]["distance_mm"], 1500);
  EXPECT_LT(both["surfaces"][0]["distance_mm"], 1513);
  const json& wall = both["surfaces"][1];
  EXPECT_NEAR(wall["distance_mm"], 1578, 3 * wall["sigma_mm"].get<double>());
}

TEST_F(SurfaceVerbs, ListARecordingWithoutACalibrationByPosition) {
  ASSERT_EQ(
      fathom("capture --rig sim:target=stair,distance=1500 --from 880 --to 1030 --step 15 -o s")
          .status,
      0);
  const json found = list("--rig replay:s");
  EXPECT_EQ(found["order"], "largest position first");
  ASSERT_EQ(found["surfaces"].size(), 4u);
  double last = 1e9;
  for (const json& step : found["surfaces"]) {
    EXPECT_TRUE(step["distance_mm"].is_null());
    EXPECT_LT(step["position"], last);
    last = step["position"];
  }
  const Outcome outcome = fathom("range --all --rig replay:s");
  EXPECT_NE(outcome.out.find("4 surfaces, the largest position first: no calibration"),
            std::string::npos)
      << outcome.out;
}

TEST_F(SurfaceVerbs, DoNotBelieveAFocusThatLiesBeyondTheRange) {
  for (const char* rig : {"sim:target=slant,distance=1500", "sim:target=usaf,distance=1500"}) {
    for (const char* range : {" --from 400 --to 800 --step 20", " --from 100 --to 400 --step 20",
                              " --from 1000 --to 1200 --step 10"}) {
      const Outcome outcome = fathom("range --all --json --rig " + std::string(rig) + range);
      EXPECT_EQ(outcome.status, 3) << rig << range << outcome.out;
      EXPECT_EQ(outcome.lines().at(0).at("surfaces").size(), 0u) << rig << range;
    }
  }
}

TEST_F(SurfaceVerbs, RefuseWhatWouldHarmOrMisreadARecording) {
  ASSERT_EQ(fathom("capture --rig sim --from 900 --to 1000 --step 20 -o stack").status, 0);
  for (const char* verb : {"focus -o", "sweep -o", "range --all --csv"}) {
    const Outcome outcome = fathom(std::string(verb) + " stack/manifest.csv --rig replay:stack");
    EXPECT_EQ(outcome.status, 2) << verb << outcome.err;
    EXPECT_NE(outcome.err.find("would destroy"), std::string::npos) << outcome.err;
  }
  for (const char* verb : {"depth -o map --from 920", "range --all --average 3"}) {
    const Outcome outcome = fathom(std::string(verb) + " --rig replay:stack");
    EXPECT_EQ(outcome.status, 2) << verb;
    EXPECT_NE(outcome.err.find("for a sweep"), std::string::npos) << outcome.err;
  }
  const Outcome map = fathom("depth --rig replay:stack -o stack");
  EXPECT_EQ(map.status, 2);
  EXPECT_NE(map.err.find("a folder of its own"), std::string::npos) << map.err;
}

TEST_F(SurfaceVerbs, AimAWindowAtTheNearestSurface) {
  calibrate();
  const Outcome nearest = fathom(
      "range --rig sim:target=stair,distance=1500 --window nearest --calibration cal.json --from "
      "800 --to 1100 "
      "--json");
  ASSERT_EQ(nearest.status, 0) << nearest.err;
  const auto [x, y, n] = window_of(nearest);
  EXPECT_GE(x, 184) << nearest.err;
  EXPECT_LE(x + n, 256);
  const json answer = nearest.lines().at(0);
  EXPECT_NEAR(answer["distance_mm"], 1455, 8);  // a quarter of a step
  EXPECT_NE(nearest.err.find("on the nearest surface"), std::string::npos);

  const Outcome textured =
      fathom("focus --rig sim:target=usaf,distance=1500 --window auto --from 800 --to 1100");
  ASSERT_EQ(textured.status, 0) << textured.err;
  EXPECT_NE(textured.err.find("the most texture of one depth"), std::string::npos);
  EXPECT_EQ(window_of(textured)[2], 64);
  const Outcome small = fathom(
      "focus --rig sim:target=stair,distance=1500 --window auto --metric fft:32 --from 800 --to "
      "1100");
  EXPECT_EQ(window_of(small)[2], 32) << small.err;
}

TEST_F(SurfaceVerbs, SayWhatDoesNotGoTogether) {
  calibrate();
  expect_refusal("range --all --rig sim --window 1,2,64 --repeat 3", 2, {"--window, --repeat"});
  expect_refusal("range --all --rig sim --window auto", 2, {"--all", "--window"});
  expect_refusal("range --rig sim", 2, {"--calibration", "--all"});
  expect_refusal("range --rig sim --calibration cal.json --csv x.csv", 2, {"--csv", "--all"});
  expect_refusal("range --all --rig sim --from 900 --to 901", 1, {"3 positions", "has 2"});
  expect_refusal("focus --rig sim --window nearer", 2, {"nearer", "is not a window"});
  const Outcome blank = fathom("range --all --rig sim:target=blank --from 900 --to 1000 --json");
  EXPECT_EQ(blank.status, 3);
  EXPECT_EQ(blank.lines().at(0)["result"], "no-surface");
  EXPECT_NE(blank.err.find("no surface"), std::string::npos);
}

/// In a terminal of 40 x 12, as `script` makes one.
TEST_F(SurfaceVerbs, ShowTheMapGrowingInATerminal) {
  const std::string command =
      "depth --rig sim:target=stair,distance=1500 --from 900 --to 1000 --step 20 -o map";
  const auto in_terminal = [&](const std::string& environment) {
    const std::string line = "cd " + path("") + " && env " + environment +
                             " script -qec 'stty cols 40 rows 12; " FATHOM_PROGRAM " " + command +
                             "' /dev/null >" + path("screen.txt") + " 2>&1 </dev/null";
    EXPECT_EQ(std::system(line.c_str()), 0) << contents(path("screen.txt"));
    return contents(path("screen.txt"));
  };
  const std::string plain = in_terminal("TERM=xterm NO_COLOR=1");
  EXPECT_NE(plain.find("1 of 6 frames; Ctrl-C keeps what"), std::string::npos) << plain;
  EXPECT_NE(plain.find("A\r\033[J"), std::string::npos);  // taken away at the end
  EXPECT_EQ(plain.find("38;5;"), std::string::npos);
  std::istringstream lines(plain);
  for (std::string text; std::getline(lines, text);) {
    const bool is_told = text.find(" frames; Ctrl-C") != std::string::npos;
    EXPECT_TRUE(!is_told || text.size() < 60) << text;
  }
  EXPECT_EQ(in_terminal("TERM=dumb").find("Ctrl-C keeps"), std::string::npos);
}

}  // namespace
}  // namespace fathom::test
