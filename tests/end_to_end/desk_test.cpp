// SPDX-License-Identifier: Apache-2.0
// Each desk of docs/rigs.md, with the rig file that its page gives: what stands on the desk is played
// here; the program, its protocols and its files are real.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "hal/drivers/simulated/thin_lens.hpp"
#include "indi_scene.hpp"
#include "program.hpp"
#include "tests/unit/hal/alpaca/fake_server.hpp"
#include "tests/unit/hal/aravis/fake_gige.hpp"
#include "tests/unit/hal/serial/simulated_stage.hpp"

namespace fathom::test {
namespace {

constexpr double kTarget_mm = 1800;
constexpr double kTravel_steps = 1200;  // of the simulated lens that every desk looks through

using Changes = std::vector<std::pair<std::string, std::string>>;

class Desk : public Program {
 protected:
  Desk() : scene_(kTarget_mm) {}

  /// An example's rig file with what differs from desk to desk put in; all of it must be there.
  void take_example(const std::string& name, const Changes& changes) {
    std::string text = contents(std::string(FATHOM_EXAMPLE_RIGS "/") + name);
    for (const auto& [from, to] : changes) {
      const std::size_t at = text.find(from);
      ASSERT_NE(at, std::string::npos) << from << " in " << name;
      text.replace(at, from.size(), to);
    }
    write("desk.toml", text);
  }

  /// From the rig file to a focus, a calibration and a distance. unit: the lens's in one step of the
  /// simulated lens.
  void focus_and_range(double unit) {
    const Outcome focused = fathom("focus --rig desk.toml --json");
    ASSERT_EQ(focused.status, 0) << focused.err << focused.out;
    EXPECT_NEAR(focused.lines().back().at("position").get<double>(), place_of(kTarget_mm, unit),
                3 * unit);
    std::string points = "position,distance_mm\n";
    for (const double mm : {1400., 1600., 2000., 2300., 2600.})
      points += std::to_string(place_of(mm, unit)) + "," + std::to_string(mm) + "\n";
    write("points.csv", points);
    const Outcome fitted = fathom("calibrate --from points.csv -o cal.json");
    ASSERT_EQ(fitted.status, 0) << fitted.err;
    const Outcome ranged = fathom("range --rig desk.toml --calibration cal.json --json");
    ASSERT_EQ(ranged.status, 0) << ranged.err;
    EXPECT_NEAR(ranged.lines().back().at("distance_mm").get<double>(), kTarget_mm,
                0.01 * kTarget_mm);
  }

  static double place_of(double distance_mm, double unit) {
    return simulated::focused_position_steps(distance_mm) * unit;
  }

  SimulatedScene scene_;
};

/// A camera on a cable of its own beside a stage that speaks text.
class GigeDesk : public Desk {
 protected:
  /// most: where the stage stands when the simulated lens is all the way out, as it counts.
  void put_stage(const std::string& profile, double most) {
    stage_ = make_stage(profile, 4 * most);
    camera_.paint(
        [this, most] { return scene_.at(stage_->motor().position() / most * kTravel_steps); });
  }

  void put_machine_vision() {
    put_stage("zaber", 500);
    take_example("machine-vision.toml",
                 {{"FLIR-12345678", FakeGige::kAddress},
                  {"gain = 0", "width = 256\nheight = 240"},
                  {"/dev/serial/by-id/usb-FTDI_FT232R-if00-port0", stage_->port()},
                  {"highest = 100000", "highest = 500"},
                  {"step = 20", "step = 1\nsettle_ms = 1"}});
  }

  std::unique_ptr<SimulatedStage> stage_;
  FakeGige camera_;
};

TEST_F(GigeDesk, AMachineVisionCameraBesideAStage) {
  put_machine_vision();
  const Outcome home = fathom("rigs home desk.toml");
  ASSERT_EQ(home.status, 0) << home.err;
  focus_and_range(500 / kTravel_steps);
  EXPECT_NEAR(stage_->motor().position(), place_of(kTarget_mm, 500 / kTravel_steps), 3)
      << "the lens is left where it was focused or measured";
}

TEST_F(GigeDesk, AMicroscope) {
  put_stage("prior", 2000);  // it counts tenths of a micrometre
  take_example("microscope.toml",
               {{"Basler-21234567", FakeGige::kAddress},
                {"exposure_ms = 5", "width = 256\nheight = 240"},
                {"/dev/serial/by-id/usb-Prior_Scientific-if00-port0", stage_->port()},
                {"settle_ms = 50", "settle_ms = 1"}});
  focus_and_range(200 / kTravel_steps);
}

TEST_F(GigeDesk, AMacroRail) {
  put_stage("grbl", 80);
  take_example("serial.toml", {{"driver = \"v4l2\"", "driver = \"aravis\""},
                               {"device = \"/dev/video0\"", "width = 256\nheight = 240"},
                               {"/dev/ttyUSB0", stage_->port()},
                               {"settle_ms = 150", "settle_ms = 1"}});
  const Outcome home = fathom("rigs home desk.toml --at 0");
  ASSERT_EQ(home.status, 0) << home.err;
  focus_and_range(80 / kTravel_steps);
}

TEST_F(GigeDesk, ALensThatTheCameraMoves) {
  camera_.paint([this] { return scene_.at(camera_.lens_position()); });
  const Outcome focused =
      fathom("focus --rig aravis:127.0.0.1,width=256,height=240,lens=FocusPos,settle_ms=1 --json");
  ASSERT_EQ(focused.status, 0) << focused.err;
  EXPECT_NEAR(focused.lines().back().at("position").get<double>(),
              simulated::focused_position_steps(kTarget_mm), 3);
}

TEST_F(GigeDesk, ACameraThatIsPulledEndsARunWithAReasonAndTheStageStands) {
  put_machine_vision();
  ASSERT_EQ(fathom("rigs home desk.toml").status, 0);
  camera_.vanish();
  const Outcome outcome = fathom("focus --rig desk.toml");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("127.0.0.1"), std::string::npos) << outcome.err;
  EXPECT_FALSE(stage_->motor().is_moving());
}

TEST_F(Desk, ATelescopeBehindAlpaca) {
  double drawn = -1;
  Painter painter;
  const FakeAlpaca server({.width_px = 512,
                           .height_px = 480,
                           .brightest = 255,
                           .travel = 1200,
                           .most_at_once = 500,
                           .steps_per_s = 50'000},
                          [&](int x, int y, double step) {
                            if (step != drawn) painter = scene_.at(drawn = step);
                            return int{painter(x, y)};
                          });
  take_example("alpaca.toml", {{"192.168.1.40:11111", "127.0.0.1:" + std::to_string(server.port())},
                               {"exposure_ms = 500", "exposure_ms = 2"},
                               {"settle_ms = 200", "settle_ms = 1"}});
  focus_and_range(1);
}

TEST_F(Desk, ATelescopeBehindIndi) {
  FakeServer server;
  show_scene(server, scene_, kTravel_steps, [] {});
  take_example("indi.toml", {{"localhost:7624", server.address()},
                             {"\"CCD Simulator\"", "\"Cam\""},
                             {"\"Focuser Simulator\"", "\"Foc\""},
                             {"exposure_ms = 500", "exposure_ms = 2"},
                             {"height = 256", "height = 240"},
                             {"settle_ms = 100", "settle_ms = 1"}});
  focus_and_range(kIndiTravel / kTravel_steps);
}

TEST_F(Desk, AWebcamWithinArmsLength) {
  ASSERT_EQ(fathom("calibrate --rig sim:lens=webcam --distances 150,200,250,300,400 "
                   "--model auto -o cal.json")
                .status,
            0);
  const Outcome ranged =
      fathom("range --rig sim:lens=webcam,distance=220 --calibration cal.json --json");
  ASSERT_EQ(ranged.status, 0) << ranged.err;
  EXPECT_NEAR(ranged.lines().back().at("distance_mm").get<double>(), 220, 0.03 * 220);
}

}  // namespace
}  // namespace fathom::test
