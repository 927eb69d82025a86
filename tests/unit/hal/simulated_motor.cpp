// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "hal/drivers/simulated/motor.hpp"
#include "simulated_support.hpp"

namespace fathom {
namespace {

using simulated::Motor;

TEST(SimulatedMotor, GoingUpwardTheLensStandsWhereTheCounterSays) {
  Motor motor(1, 0, 4, 25);
  motor.step_ns(300);
  EXPECT_EQ(motor.counter(), 300);
  EXPECT_EQ(motor.lens(), 300);
}

TEST(SimulatedMotor, TurningRoundLosesThePlayAndTurningBackRegainsIt) {
  Motor motor(1, 0, 4, 25);
  motor.step_ns(300);
  motor.step_ns(-3);
  EXPECT_EQ(motor.lens(), 300) << "still within the play";
  motor.step_ns(-97);
  EXPECT_EQ(motor.counter(), 200);
  EXPECT_EQ(motor.lens(), 204);
  motor.step_ns(4);
  EXPECT_EQ(motor.lens(), 204) << "the play again";
  motor.step_ns(1);
  EXPECT_EQ(motor.lens(), 205);
}

TEST(SimulatedMotor, EndStopsHoldTheLens) {
  Motor motor(1, 1190, 4, 25);
  motor.step_ns(50);
  EXPECT_EQ(motor.lens(), 1200);
  motor.step_ns(-2000);
  EXPECT_EQ(motor.lens(), 0);
  motor.step_ns(4);  // the motor stands against the stop at once, however long it was pushed
  EXPECT_EQ(motor.lens(), 0);
  motor.step_ns(10);
  EXPECT_EQ(motor.lens(), 10);
}

TEST(SimulatedMotor, MovesTakeTheirTime) {
  Motor motor(1, 0, 4, 25);
  EXPECT_EQ(motor.step_ns(100), 4'000'000'000);
  EXPECT_EQ(motor.step_ns(-25), 1'000'000'000);
}

TEST(SimulatedMotor, StallsAboveFortyStepsASecond) {
  Motor slow(1, 0, 4, 40);
  slow.step_ns(1000);
  EXPECT_EQ(slow.lens(), 1000);
  Motor fast(1, 0, 4, 50);
  fast.step_ns(1000);
  EXPECT_EQ(fast.counter(), 1000);
  EXPECT_NEAR(fast.lens(), 800, 50) << "it follows 40 of 50 steps a second";
}

TEST(SimulatedMotor, LosesStepsOnceWhenTold) {
  Motor motor(1, 0, 4, 25);
  motor.lose_in_next_long_move(30);
  motor.step_ns(20);
  EXPECT_EQ(motor.lens(), 20) << "a short move";
  motor.step_ns(100);
  EXPECT_EQ(motor.counter(), 120);
  EXPECT_EQ(motor.lens(), 90);
  motor.step_ns(100);
  EXPECT_EQ(motor.lens(), 190);
}

/// Frames without noise show where the lens truly stands.
std::vector<std::uint32_t> view(test::SimulatedRig& rig) { return test::pixels(rig.grab()); }

TEST(SimulatedLens, OnePositionIsOnePlaceWhicheverWayItCame) {
  test::SimulatedRig rig("sim:noise=0,backlash=7");
  for (const double position : {0.0, 3.0, 700.0}) {
    rig.lens().home();
    rig.lens().move_to(position);
    const auto from_below = view(rig);
    rig.lens().move_to(900);
    EXPECT_NE(view(rig), from_below);
    rig.lens().move_to(position);
    EXPECT_EQ(view(rig), from_below) << position;
    EXPECT_EQ(rig.lens().position(), position);
  }
}

TEST(SimulatedLens, LostStepsShiftTheLensUntilItIsSentHome) {
  test::SimulatedRig sound("sim:noise=0"), slipping("sim:noise=0,lose=60");
  sound.lens().move_to(780);
  slipping.lens().move_to(780);
  EXPECT_EQ(slipping.lens().position(), 780) << "it does not know";
  EXPECT_NE(view(slipping), view(sound));
  EXPECT_EQ(slipping.lens().home().position, 0);
  slipping.lens().move_to(780);
  EXPECT_EQ(view(slipping), view(sound));
}

TEST(SimulatedLens, StartsWhereItIsTold) {
  test::SimulatedRig rig("sim:noise=0,start=640"), moved("sim:noise=0");
  EXPECT_EQ(rig.lens().position(), 640);
  moved.lens().move_to(640);
  EXPECT_EQ(view(rig), view(moved));
}

TEST(SimulatedLens, AnswersForItsTravel) {
  test::SimulatedRig rig("sim");
  const LensInfo info = rig.lens().info();
  EXPECT_EQ(info.unit, "steps");
  EXPECT_EQ(info.lowest, 0);
  EXPECT_EQ(info.highest, 1200);
  EXPECT_EQ(info.resolution, 1);
  EXPECT_EQ(info.coarse_spacing, 112);
  EXPECT_EQ(info.optics, (Optics{135, 4, 0.04}));
  EXPECT_EQ(test::SimulatedRig("sim:fnumber=2.8").lens().info().optics->f_number, 2.8);
  EXPECT_EQ(rig.lens().nearest(10.6), 11);
  EXPECT_EQ(rig.lens().nearest(-5), 0);
  EXPECT_EQ(rig.lens().nearest(1300), 1200);
  EXPECT_EQ(rig.lens().move_to(10.6).position, 11);
}

}  // namespace
}  // namespace fathom
