// SPDX-License-Identifier: Apache-2.0
// What hal/camera.hpp promises, of every camera.
#include <limits>

#include "fixtures.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

class CameraConformance : public RigConformance {};

TEST_P(CameraConformance, DescribesItselfInOneLine) {
  EXPECT_FALSE(camera().description().empty());
  EXPECT_EQ(camera().description().find('\n'), std::string::npos);
}

TEST_P(CameraConformance, ItsOwnSettingsAreValid) {
  const CameraSettings own = camera().settings();
  CameraSettings wished = own;
  EXPECT_EQ(camera().validate(wished), Validity::valid);
  EXPECT_EQ(wished, own);
  camera().apply(wished);
  EXPECT_EQ(camera().settings(), own);
}

TEST_P(CameraConformance, AWishBeyondItIsAdjustedToOneThatIsValid) {
  CameraSettings wished = camera().settings();
  wished.width_px = std::numeric_limits<int>::max();
  wished.height_px = std::numeric_limits<int>::max();
  wished.exposure_ms = 1e12;
  const CameraSettings asked = wished;
  ASSERT_EQ(camera().validate(wished), Validity::adjusted);
  EXPECT_NE(wished, asked);
  EXPECT_EQ(camera().validate(wished), Validity::valid);
  camera().apply(wished);
  EXPECT_EQ(camera().settings(), wished);
  const Frame frame = grab();
  EXPECT_EQ(frame.width_px(), wished.width_px);
  EXPECT_EQ(frame.height_px(), wished.height_px);
}

TEST_P(CameraConformance, WhatHasNoMeaningIsRefusedAndChangesNothing) {
  const CameraSettings own = camera().settings();
  CameraSettings wishes[] = {own, own, own, own, own};
  wishes[0].width_px = 0;
  wishes[1].height_px = -3;
  wishes[2].exposure_ms = -1;
  wishes[3].exposure_ms = std::numeric_limits<double>::quiet_NaN();
  wishes[4].width_px = std::numeric_limits<int>::min();
  for (CameraSettings& wish : wishes) {
    const CameraSettings asked = wish;
    EXPECT_EQ(camera().validate(wish), Validity::refused);
    EXPECT_EQ(wish.width_px, asked.width_px);
    EXPECT_EQ(wish.height_px, asked.height_px);
    expect_error(ErrorCode::unsupported, [&] { camera().apply(asked); });
    EXPECT_EQ(camera().settings(), own);
  }
}

TEST_P(CameraConformance, ApplyRefusesWhatIsOnlyNearlyValid) {
  const CameraSettings own = camera().settings();
  CameraSettings wished = own;
  wished.width_px = std::numeric_limits<int>::max();
  expect_error(ErrorCode::unsupported, [&] { camera().apply(wished); });
  EXPECT_EQ(camera().settings(), own);
}

TEST_P(CameraConformance, FramesHaveTheShapeOfTheSettings) {
  const CameraSettings own = camera().settings();
  const Frame frame = grab();
  EXPECT_EQ(frame.width_px(), own.width_px);
  EXPECT_EQ(frame.height_px(), own.height_px);
  EXPECT_EQ(frame.depth(), own.depth);
}

TEST_P(CameraConformance, FramesComeInOrderAndAreStamped) {
  std::int64_t last_start = std::numeric_limits<std::int64_t>::min();
  std::int64_t last_end = last_start;
  for (int i = 0; i < 5; ++i) {
    const Frame frame = grab();
    EXPECT_GT(frame.exposure.start_ns, last_start);
    EXPECT_GT(frame.exposure.end_ns, last_end);
    EXPECT_GE(frame.exposure.end_ns, frame.exposure.start_ns);
    last_start = frame.exposure.start_ns;
    last_end = frame.exposure.end_ns;
  }
}

TEST_P(CameraConformance, AFrameOfTheSettledLensComesAndIsStampedAfterIt) {
  const LensInfo info = lens().info();
  for (const double share : {0.3, 1.0, 0.0, 0.6}) {
    const Arrival arrival = lens().move_to(info.lowest + share * (info.highest - info.lowest));
    const Frame frame = grab_after(arrival.settled_ns);
    EXPECT_GE(frame.exposure.start_ns, arrival.settled_ns);
    EXPECT_EQ(frame.lens_position.value_or(arrival.position), arrival.position);
  }
}

TEST_P(CameraConformance, AnImpatientGrabEndsWithoutAFrameOrWithOne) {
  for (int i = 0; i < 3; ++i) EXPECT_NO_THROW(camera().grab(0ms));
  EXPECT_FALSE(grab().empty());
}

TEST_P(CameraConformance, AStillCameraGivesTheSameFrameAgain) {
  if (camera().is_live()) GTEST_SKIP() << "two frames of a live camera differ by noise";
  EXPECT_EQ(pixels_of(grab()), pixels_of(grab()));
}

INSTANTIATE_TEST_SUITE_P(Rigs, CameraConformance, testing::ValuesIn(rig_fixtures()), fixture_label);

}  // namespace
}  // namespace fathom::test
