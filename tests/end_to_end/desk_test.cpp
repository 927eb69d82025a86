// SPDX-License-Identifier: Apache-2.0
// A desk as one rig file has it: a GigE Vision camera on a cable of its own, and a stage that speaks
// text. Both are played here; the program, its protocols and its files are real.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "hal/drivers/simulated/thin_lens.hpp"
#include "program.hpp"
#include "tests/unit/hal/alpaca/fake_server.hpp"
#include "tests/unit/hal/aravis/fake_gige.hpp"
#include "tests/unit/hal/serial/simulated_stage.hpp"

namespace fathom::test {
namespace {

constexpr double kTarget_mm = 1800;
/// Of the simulated lens, for each microstep of the stage, which has 500.
constexpr double kSteps = 2.4;

double microsteps_of(double distance_mm) {
  return simulated::focused_position_steps(distance_mm) / kSteps;
}

class Desk : public Program {
 protected:
  Desk() : stage_(make_stage("zaber", 20'000)), scene_(kTarget_mm) {
    camera_.paint([this] { return scene_.at(kSteps * stage_->motor().position()); });
    write("desk.toml",
          "[camera]\ndriver = \"aravis\"\ncamera = \"127.0.0.1\"\n"
          "width = 256\nheight = 240\n"
          "[lens]\ndriver = \"serial\"\nprofile = \"zaber\"\nport = \"" +
              stage_->port() + "\"\nlowest = 0\nhighest = 500\nstep = 1\nsettle_ms = 1\n");
  }

  std::unique_ptr<SimulatedStage> stage_;
  SimulatedScene scene_;
  FakeGige camera_;
};

TEST_F(Desk, FindsAFocusAndTellsADistance) {
  const Outcome home = fathom("rigs home desk.toml");
  ASSERT_EQ(home.status, 0) << home.err;
  const Outcome focused = fathom("focus --rig desk.toml --json");
  ASSERT_EQ(focused.status, 0) << focused.err << focused.out;
  const double truth = microsteps_of(kTarget_mm);
  EXPECT_NEAR(focused.lines().back().at("position").get<double>(), truth, 3);
  EXPECT_NEAR(stage_->motor().position(), truth, 3) << "the lens is left at the focus";

  std::string points = "position,distance_mm\n";
  for (const double mm : {1400., 1600., 2000., 2300., 2600.})
    points += std::to_string(microsteps_of(mm)) + "," + std::to_string(mm) + "\n";
  write("points.csv", points);
  const Outcome fitted = fathom("calibrate --from points.csv -o cal.json");
  ASSERT_EQ(fitted.status, 0) << fitted.err;
  const Outcome ranged = fathom("range --rig desk.toml --calibration cal.json --json");
  ASSERT_EQ(ranged.status, 0) << ranged.err;
  EXPECT_NEAR(ranged.lines().back().at("distance_mm").get<double>(), kTarget_mm, 0.01 * kTarget_mm);
}

TEST_F(Desk, ALensThatTheCameraMovesIsFocusedToo) {
  camera_.paint([this] { return scene_.at(camera_.lens_position()); });
  const Outcome focused =
      fathom("focus --rig aravis:127.0.0.1,width=256,height=240,lens=FocusPos,settle_ms=1 --json");
  ASSERT_EQ(focused.status, 0) << focused.err;
  EXPECT_NEAR(focused.lines().back().at("position").get<double>(),
              simulated::focused_position_steps(kTarget_mm), 3);
}

TEST_F(Desk, ATelescopeBehindAlpacaIsFocusedToo) {
  SimulatedScene scene(kTarget_mm);
  double drawn = -1;
  Painter painter;
  const FakeAlpaca server({.width_px = 256,
                           .height_px = 240,
                           .brightest = 255,
                           .travel = 1200,
                           .most_at_once = 500,
                           .steps_per_s = 50'000},
                          [&](int x, int y, double step) {
                            if (step != drawn) painter = scene.at(drawn = step);
                            return int{painter(x, y)};
                          });
  const Outcome focused =
      fathom("focus --json --rig " + server.rig(",exposure_ms=2,settle_ms=1,backlash=5"));
  ASSERT_EQ(focused.status, 0) << focused.err;
  EXPECT_NEAR(focused.lines().back().at("position").get<double>(),
              simulated::focused_position_steps(kTarget_mm), 3);
}

TEST_F(Desk, ACameraThatIsPulledEndsARunWithAReasonAndTheStageStands) {
  ASSERT_EQ(fathom("rigs home desk.toml").status, 0);
  camera_.vanish();
  const Outcome outcome = fathom("focus --rig desk.toml");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("127.0.0.1"), std::string::npos) << outcome.err;
  EXPECT_FALSE(stage_->motor().is_moving());
}

}  // namespace
}  // namespace fathom::test
