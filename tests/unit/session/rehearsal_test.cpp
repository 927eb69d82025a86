// SPDX-License-Identifier: Apache-2.0
#include "session/rehearsal.hpp"

#include <gtest/gtest.h>

namespace fathom {
namespace {

class RehearsalTest : public ::testing::Test {
 protected:
  RehearsalTest() : rig_(options()) {}

  static RigOptions options() {
    RigOptions options;
    options.rig = "sim:target=seedling,distance=1800,seed=3";
    options.backend = "cpu";
    return options;
  }

  Rig rig_;
};

TEST_F(RehearsalTest, FindsTheFocusOfItsPicturesAgainAndAgain) {
  Rehearsal rehearsal(rig_, {});
  const Focus first = rehearsal.run(), second = rehearsal.run();
  EXPECT_EQ(first.result(), FocusResult::focused);
  EXPECT_GE(first.evaluations.size(), 8U);
  EXPECT_EQ(first.evaluations, second.evaluations);
  EXPECT_EQ(first.position(), second.position());
}

TEST_F(RehearsalTest, LeavesTheLensWhereItWasAndDoesNotMoveIt) {
  rig_.lens().move_to(200);
  Rehearsal rehearsal(rig_, {});
  EXPECT_EQ(rig_.lens().position(), 200);
  rig_.lens().move_to(300);
  rehearsal.run();
  EXPECT_EQ(rig_.lens().position(), 300);
}

TEST_F(RehearsalTest, TellsHowLongAPictureTakesOnTheRig) {
  Rehearsal rehearsal(rig_, {});
  EXPECT_GT(rehearsal.cycle_s(), 0.1);
  EXPECT_LT(rehearsal.cycle_s(), 60);
}

}  // namespace
}  // namespace fathom
