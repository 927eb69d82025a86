// SPDX-License-Identifier: Apache-2.0
// What TargetStage in hal/rig_driver.hpp promises, of every rig that has one.
#include <limits>

#include "fixtures.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

class StageConformance : public RigConformance {};

TEST_P(StageConformance, PutsTheTargetWhereItIsTold) {
  if (rig_.stage == nullptr) GTEST_SKIP() << "this rig has no stage";
  for (const double distance_mm : {1500.0, 2500.5, 1400.0}) {
    rig_.stage->place_at(distance_mm);
    EXPECT_EQ(rig_.stage->distance_mm(), distance_mm);
  }
}

TEST_P(StageConformance, RefusesWhatItCannotReachAndLeavesTheTarget) {
  if (rig_.stage == nullptr) GTEST_SKIP() << "this rig has no stage";
  rig_.stage->place_at(1500);
  for (const double distance_mm : {-1.0, 0.0, 1e12, std::numeric_limits<double>::quiet_NaN()}) {
    expect_error(ErrorCode::out_of_bounds, [&] { rig_.stage->place_at(distance_mm); });
    EXPECT_EQ(rig_.stage->distance_mm(), 1500);
  }
}

INSTANTIATE_TEST_SUITE_P(Rigs, StageConformance, testing::ValuesIn(rig_fixtures()), fixture_label);

}  // namespace
}  // namespace fathom::test
