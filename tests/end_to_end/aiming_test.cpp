// SPDX-License-Identifier: Apache-2.0
// Windows that the program chooses, surfaces that it lists, and the runs that both leave.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

const std::string kSweep = " --from 800 --to 1100 --step 15";

class Aiming : public Program {
 protected:
  void calibrate() {
    ASSERT_EQ(fathom("calibrate --rig sim --distances 1350,1400,1450,1500,1550,1600,1700,1800 "
                     "--model thin-lens -o cal.json")
                  .status,
              0);
    fs::remove_all(path("state"));
  }

  std::vector<fs::path> runs() const {
    std::vector<fs::path> all;
    if (!fs::exists(path("state/fathom/runs"))) return all;
    for (const auto& entry : fs::directory_iterator(path("state/fathom/runs")))
      all.push_back(entry.path());
    return all;
  }

  json only_run() const {
    EXPECT_EQ(runs().size(), 1u);
    return runs().empty() ? json::object() : json::parse(contents(runs().at(0)));
  }

  static bool has(const std::string& text, const std::string& words) {
    return text.find(words) != std::string::npos;
  }
};

TEST_F(Aiming, WithoutAWindowItEndsAsASearchThatFindsNoFocus) {
  const std::string rig = " --window auto --rig sim:distance=1500,target=";
  const Outcome blank = fathom("focus --json --from 900 --to 1000" + rig + "blank");
  EXPECT_EQ(blank.status, 3) << blank.err;
  EXPECT_EQ(blank.lines().at(0)["result"], "no-focus");
  EXPECT_TRUE(blank.lines().at(0)["position"].is_null());
  EXPECT_TRUE(has(blank.err, "more light or texture")) << blank.err;
  // What was measured is kept.
  EXPECT_GT(only_run()["runs"][0]["evaluations"].size(), 10u);
  EXPECT_EQ(fathom("rerun " + runs().at(0).string()).status, 0);
  // A lamp that drifts makes noise stronger towards an end, and no focus beyond it.
  const Outcome drifting =
      fathom("focus --json --window auto --rig sim:target=blank,seed=1,drift=5");
  EXPECT_EQ(drifting.lines().at(0)["result"], "no-focus") << drifting.err;
  EXPECT_EQ(fathom("sweep --from 900 --to 1000 -o s.json" + rig + "blank").status, 3);
  EXPECT_TRUE(fs::exists(path("s.json")));
}

TEST_F(Aiming, NamesTheEndBeyondWhichTheFocusLies) {
  calibrate();
  const std::string rig = " --window nearest --rig sim:target=slant,distance=";
  const Outcome below = fathom("focus --json --from 500 --to 800" + rig + "1500");
  EXPECT_EQ(below.status, 3) << below.err;
  EXPECT_EQ(below.lines().at(0)["result"], "at-limit");
  EXPECT_TRUE(has(below.err, "--to above 788 steps")) << below.err;
  const Outcome above =
      fathom("range --calibration cal.json --json --from 1050 --to 1200" + rig + "1500");
  EXPECT_EQ(above.status, 3) << above.err;
  EXPECT_TRUE(above.lines().at(0)["distance_mm"].is_null());
  EXPECT_TRUE(has(above.err, "--from below 1050 steps")) << above.err;
  ASSERT_EQ(
      fathom("capture --rig sim:target=slant,distance=1500 --from 600 --to 800 --step 10 -o s")
          .status,
      0);
  const Outcome recorded = fathom("focus --rig replay:s --window auto");
  EXPECT_EQ(recorded.status, 3);
  EXPECT_TRUE(has(recorded.out, "at-limit")) << recorded.out;
  EXPECT_TRUE(has(recorded.out, "the recording ends there")) << recorded.out;
}

TEST_F(Aiming, HoldsADistanceAgainstWhatTheWindowShows) {
  calibrate();
  const Outcome step = fathom(
      "range --rig sim:target=stair,distance=1500 --window nearest --calibration cal.json --from "
      "800 "
      "--to 1100");
  EXPECT_EQ(step.status, 0) << step.err;
  EXPECT_TRUE(has(step.out, "what the window shows of the simulated target stands at 145"))
      << step.out;
  EXPECT_FALSE(has(step.err, "use --")) << step.err;
  const Outcome slant = fathom(
      "range --rig sim:target=slant,distance=1500 --calibration cal.json --from 800 --to 1100");
  EXPECT_TRUE(has(slant.out, "in the mean, 14")) << slant.out;
  const Outcome chart = fathom("range --rig sim:distance=1500 --calibration cal.json");
  EXPECT_TRUE(has(chart.out, "the simulated target stands at 1500.0 mm: off")) << chart.out;
}

TEST_F(Aiming, OpensTheRigOnce) {
  const std::string focus =
      "focus --rig sim:target=stair,distance=1500 --from 900 --to 1000 -o run.json";
  const auto started_s = [&](const std::string& more) {
    EXPECT_EQ(fathom(focus + more).status, 0);
    const json run = json::parse(contents(path("run.json")));
    return 1e-9 * run["runs"][0]["started_ns"].get<double>();
  };
  // On the clock of one rig the search begins after the look round; that of another begins anew.
  EXPECT_LT(started_s(""), 1);
  EXPECT_GT(started_s(" --window auto"), 20);
}

TEST_F(Aiming, IsOfVerbsThatLookRound) {
  const Outcome sweep =
      fathom("sweep --rig sim:target=stair,distance=1500 --window auto --json" + kSweep);
  EXPECT_EQ(sweep.status, 0) << sweep.err;
  EXPECT_TRUE(has(sweep.err, "the most texture of one depth")) << sweep.err;
  EXPECT_EQ(only_run()["runs"].size(), 1u);
  expect_refusal("calibrate --rig sim --distances 1400,1500 --window auto -o c.json", 2,
                 {"focus, range and sweep", "X,Y,N"});
}

TEST_F(Aiming, KeepsARunOfEverySurface) {
  calibrate();
  const std::string command =
      "range --all --rig sim:target=stair,distance=1500 --calibration cal.json" + kSweep;
  ASSERT_EQ(fathom(command).status, 0);
  const json run = only_run();
  EXPECT_EQ(run["setup"]["verb"], "range");
  EXPECT_EQ(run["runs"][0]["evaluations"].size(), 21u);
  EXPECT_EQ(run["surfaces"].size(), 4u);
  const std::string kept = runs().at(0).string();
  const Outcome again = fathom("rerun " + kept);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_TRUE(has(again.err, "cannot be checked")) << again.err;
  EXPECT_TRUE(has(again.out, "surface at 98")) << again.out;
  json edited = run;
  edited["surfaces"][1]["position"] = run["surfaces"][1]["position"].get<double>() + 3;
  write("edited.json", edited.dump());
  expect_refusal("rerun edited.json", 1, {"does not come to the answer"});

  ASSERT_EQ(fathom("capture --rig sim:target=stair,distance=1500 -o s" + kSweep).status, 0);
  ASSERT_EQ(fathom("range --all --rig replay:s --json -o r.json").status, 0);
  EXPECT_EQ(json::parse(contents(path("r.json")))["surfaces"].size(), 4u);
  EXPECT_EQ(fathom("rerun r.json --json").lines().size(), 4u);
}

TEST_F(Aiming, AStopIsToldAndNoSuccess) {
  // Long enough for three frames under sanitizers, short of the last one without.
  const Outcome list = fathom("range --all --rig sim:target=stair --average 400 --json -o r.json",
                              "timeout --foreground --preserve-status -s INT 6");
  EXPECT_EQ(list.status, 1) << list.err;
  EXPECT_TRUE(has(list.err, "stopped after ")) << list.err;
  EXPECT_EQ(json::parse(contents(path("r.json")))["error"].get<std::string>().rfind("stopped", 0),
            0u);
  const Outcome aimed = fathom("focus --window auto --rig sim:target=stair --average 400 -o f.json",
                               "timeout --foreground --preserve-status -s INT 3");
  EXPECT_EQ(aimed.status, 1) << aimed.err;
  EXPECT_TRUE(has(aimed.err, "stopped after ")) << aimed.err;
  EXPECT_EQ(std::count(aimed.err.begin(), aimed.err.end(), '\n'), 1) << aimed.err;
  EXPECT_FALSE(has(aimed.out, "no-focus")) << aimed.out;
}

TEST_F(Aiming, OneChartIsOneSurfaceAndHiddenStepsAreInItsSigma) {
  calibrate();
  const Outcome chart = fathom("range --all --json --calibration cal.json --rig sim:distance=1500");
  ASSERT_EQ(chart.status, 0) << chart.err;
  ASSERT_EQ(chart.lines().at(0)["surfaces"].size(), 1u) << chart.out;
  EXPECT_NEAR(chart.lines().at(0)["surfaces"][0]["distance_mm"], 1500, 3);
  const std::string noisy =
      "range --all --calibration cal.json --rig sim:target=stair,distance=1500,noise=16" + kSweep;
  const json found = fathom(noisy + " --json").lines().at(0)["surfaces"];
  for (const json& surface : found) {
    // Every step that it covers lies within its sigma.
    const double width = surface["box"][2], left = surface["box"][0];
    const double nearest = 1545 - 30 * std::floor((left + width - 20) / 64);
    const double farthest = 1545 - 30 * std::floor((left + 20) / 64);
    const double mm = surface["distance_mm"], sigma = surface["sigma_mm"];
    EXPECT_LT(mm - nearest, 2.5 * sigma + 5) << surface;
    EXPECT_LT(farthest - mm, 2.5 * sigma + 5) << surface;
  }
  EXPECT_TRUE(has(fathom(noisy).out, "not level; its mean +- "));
}

TEST_F(Aiming, ScaleFollowsTheLawOfTheLens) {
  calibrate();
  // Thin lens of 135 mm, 16.81 mm farther out at 1200 steps.
  const double per_unit = 16.81 / 1200;  // mm a step
  const auto report = [&](const std::string& arguments) {
    const Outcome outcome = fathom("depth --json -o map --align " + arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out);
  };
  const std::string rig = "sim:target=slant,distance=1500,breathing=true";
  const json live = report("scale --rig " + rig + kSweep);
  const double told = live["alignment"]["told_growth_per_unit"];
  const double fitted = live["alignment"]["growth_per_unit"];
  const double truth = per_unit / (135 + 800 * per_unit);
  EXPECT_EQ(live["alignment"]["by"], "law");
  EXPECT_NEAR(told / truth, 1, 0.3);
  EXPECT_NEAR(fitted / truth, 1, 0.02);
  ASSERT_EQ(fathom("capture --rig " + rig + " -o s" + kSweep).status, 0);
  const json recorded = report("scale --calibration cal.json --rig replay:s");
  EXPECT_EQ(recorded["alignment"]["by"], "law");
  EXPECT_NEAR(recorded["alignment"]["growth_per_unit"].get<double>() / truth, 1, 0.02);
  EXPECT_EQ(report("scale --rig replay:s")["alignment"]["by"], "estimate");
  EXPECT_EQ(report("none --rig replay:s")["alignment"]["by"], "none");
}

}  // namespace
}  // namespace fathom::test
