// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "support.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

class V4l2Lens : public testing::Test {
 protected:
  Lens& open(std::map<std::string, std::string> keys = {}) {
    rig_ = Hardware();
    rig_ =
        open_v4l2(system_, std::move(keys),
                  {.camera = false, .lens = true, .stop_requests = [this] { return requests_; }});
    node_.written.clear();
    return *rig_.lens;
  }

  /// Where the lens was sent, in order.
  std::vector<int> ways() const {
    std::vector<int> ways;
    for (const auto& [id, value] : node_.written) {
      if (id == V4L2_CID_FOCUS_ABSOLUTE) ways.push_back(value);
    }
    return ways;
  }

  FakeSystem system_;
  FakeNode& node_ = add_webcam(system_);
  FakeControl& focus_ = node_.controls[V4L2_CID_FOCUS_ABSOLUTE];
  int requests_ = 0;
  Hardware rig_;
};

TEST_F(V4l2Lens, HasTheDriversRangeAndStep) {
  const LensInfo info = open().info();
  EXPECT_EQ(info.lowest, 0);
  EXPECT_EQ(info.highest, 250) << "252 is no multiple of the step";
  EXPECT_EQ(info.resolution, 5);
  EXPECT_EQ(info.unit, "units");
  EXPECT_EQ(info.coarse_spacing, 0);
  EXPECT_EQ(rig_.lens->position(), 100);
}

TEST_F(V4l2Lens, SoftLimitsLieOnPositionsThatItHas) {
  const LensInfo info = open({{"lowest", "13"}, {"highest", "97"}, {"coarse", "20"}}).info();
  EXPECT_EQ(info.lowest, 15);
  EXPECT_EQ(info.highest, 95);
  EXPECT_EQ(info.coarse_spacing, 20);
  EXPECT_EQ(rig_.lens->move_to(94).position, 95);
  expect_error(ErrorCode::out_of_bounds, [&] { rig_.lens->move_to(96); });
  EXPECT_EQ(rig_.lens->home().position, 15);
  for (const auto& [lowest, highest] :
       {std::pair{"-5", "50"}, {"0", "300"}, {"60", "50"}, {"51", "54"}}) {
    expect_error(ErrorCode::unsupported,
                 [&] {
                   open({{"lowest", lowest}, {"highest", highest}});
                 },
                 {"0 to 252"});
  }
}

TEST_F(V4l2Lens, SettlesAfterTheWay) {
  Lens& lens = open({{"settle_ms", "120"}, {"speed", "500"}});
  const Arrival arrival = lens.move_to(200);
  EXPECT_EQ(arrival.stopped_ns - arrival.started_ns, 200 * kMs);
  EXPECT_EQ(arrival.settled_ns - arrival.stopped_ns, 120 * kMs);
  EXPECT_EQ(arrival.settled_ns, system_.now_ns());
  EXPECT_EQ(focus_.value, 200);
}

TEST_F(V4l2Lens, WithoutASpeedSettlingIncludesTheWay) {
  const Arrival arrival = open().move_to(200);
  EXPECT_EQ(arrival.settled_ns - arrival.started_ns, 300 * kMs);
}

TEST_F(V4l2Lens, ALensThatIsThereDoesNotMove) {
  Lens& lens = open();
  lens.move_to(200);
  node_.written.clear();
  const Arrival arrival = lens.move_to(200);
  EXPECT_TRUE(node_.written.empty());
  EXPECT_EQ(arrival.settled_ns, arrival.started_ns);
  EXPECT_GE(arrival.stopped_ns, arrival.started_ns);
}

TEST_F(V4l2Lens, EveryMoveEndsUpward) {
  Lens& lens = open({{"backlash", "12"}});
  lens.move_to(150);
  EXPECT_EQ(ways(), (std::vector{135, 150})) << "it may have come to 100 from anywhere";
  node_.written.clear();
  lens.move_to(200);
  lens.move_to(100);
  lens.move_to(5);
  lens.move_to(0);
  EXPECT_EQ(ways(), (std::vector{200, 85, 100, 0, 5, 0}));
}

TEST_F(V4l2Lens, TheWayBackUpWaitsUntilTheWayDownIsOver) {
  Lens& lens = open({{"backlash", "12"}});
  const Arrival arrival = lens.move_to(50);
  EXPECT_EQ(ways(), (std::vector{35, 50}));
  EXPECT_EQ(arrival.stopped_ns - arrival.started_ns, 300 * kMs);
  EXPECT_EQ(arrival.settled_ns - arrival.stopped_ns, 300 * kMs);
}

TEST_F(V4l2Lens, OneThatRestsAStepBesideItsGoalIsBelieved) {
  Lens& lens = open();
  focus_.reads = [](std::int32_t sent) { return sent + 5; };
  EXPECT_EQ(lens.move_to(200).position, 205);
  EXPECT_EQ(lens.position(), 205);
  focus_.reads = [](std::int32_t sent) { return sent + 10; };
  expect_error(ErrorCode::device_lost, [&] { lens.move_to(100); }, {"100", "110"});
}

TEST_F(V4l2Lens, WhatAnotherProgramMovedIsMovedBackFromBelow) {
  Lens& lens = open({{"backlash", "12"}});
  lens.move_to(200);
  for (const int elsewhere : {50, 240}) {
    focus_.value = elsewhere;
    node_.written.clear();
    EXPECT_EQ(lens.move_to(200).position, 200);
    EXPECT_EQ(focus_.value, 200);
    EXPECT_EQ(ways(), (std::vector{185, 200}));
  }
}

TEST_F(V4l2Lens, AMoveThatAnotherProgramMadeLongerHasItsTime) {
  Lens& lens = open({{"speed", "100"}, {"settle_ms", "0"}});
  lens.move_to(200);
  focus_.value = 0;
  const Arrival arrival = lens.move_to(250);
  EXPECT_EQ(arrival.stopped_ns - arrival.started_ns, 2500 * kMs);
}

TEST_F(V4l2Lens, NumbersThatNoLensHasAreRefused) {
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  focus_.lowest = kLeast;
  focus_.highest = kMost;
  focus_.step = 1;
  expect_error(ErrorCode::unsupported, [&] { open(); }, {"2147483647", "set lowest and highest"});
  const std::map<std::string, std::string> widest = {
      {"lowest", "-1000000000"}, {"highest", "1000000000"}, {"backlash", "1e9"}, {"speed", "1e8"}};
  Lens& lens = open(widest);
  EXPECT_EQ(lens.move_to(1e9).position, 1e9);
  EXPECT_EQ(lens.move_to(-1e9).position, -1e9);
  EXPECT_EQ(lens.move_to(1e9).position, 1e9);
  EXPECT_EQ(lens.move_to(5e8).position, 5e8);
  EXPECT_EQ(ways(), (std::vector{0, 1000000000, -1000000000, 1000000000, -500000000, 500000000}));
  for (const std::int32_t elsewhere : {kLeast, kMost}) {
    focus_.value = elsewhere;
    expect_error(ErrorCode::unsupported, [&] { rig_.lens->move_to(0); }, {"no position"});
    expect_error(ErrorCode::unsupported, [&] { open_v4l2(system_, widest); }, {"no position"});
  }
}

TEST_F(V4l2Lens, AClampInSilenceIsCaught) {
  Lens& lens = open();
  focus_.becomes = [](std::int32_t value) { return std::min(value, 180); };
  EXPECT_EQ(lens.move_to(180).position, 180);
  const std::int64_t before_ns = system_.now_ns();
  expect_error(ErrorCode::device_lost, [&] { lens.move_to(200); },
               {"sent to 200", "stands at 180"});
  EXPECT_LE(system_.now_ns(), before_ns + 1000 * kMs);
  EXPECT_EQ(lens.position(), 180);
  EXPECT_EQ(lens.move_to(50).position, 50);
}

TEST_F(V4l2Lens, ALensThatReportsItsWayIsWaitedFor) {
  Lens& lens = open({{"settle_ms", "10"}});
  int reads = 0;
  focus_.reads = [&](std::int32_t value) { return std::min(value, 100 + 5 * ++reads); };
  const Arrival arrival = lens.move_to(200);
  EXPECT_EQ(arrival.position, 200);
  // One report before it is sent, and one at once after it; the twentieth is the first at 200.
  EXPECT_EQ(arrival.stopped_ns - arrival.started_ns, (20 - 2) * 20 * kMs);
}

TEST_F(V4l2Lens, ARefusalIsAnErrorThatSaysSo) {
  Lens& lens = open();
  for (const auto& [refusal, code] : {std::pair{EPIPE, ErrorCode::io},
                                      {EIO, ErrorCode::io},
                                      {EINVAL, ErrorCode::io},
                                      {ETIMEDOUT, ErrorCode::timeout},
                                      {ENODEV, ErrorCode::device_lost}}) {
    focus_.refusal = refusal;
    expect_error(code, [&] { lens.move_to(200); }, {"Focus, Absolute", "200"});
  }
  focus_.refusal = 0;
  EXPECT_EQ(lens.move_to(200).position, 200);
}

/// uvcvideo says EBUSY for a camera that is "not ready", as one may be whose lens still moves.
TEST_F(V4l2Lens, ALensThatIsNotReadyIsAskedAgain) {
  Lens& lens = open();
  focus_.refusal = EBUSY;
  const std::int64_t before_ns = system_.now_ns();
  expect_error(ErrorCode::unavailable, [&] { lens.move_to(200); }, {"200", "not ready"});
  EXPECT_GE(system_.now_ns(), before_ns + 1000 * kMs);
  EXPECT_LE(system_.now_ns(), before_ns + 1100 * kMs);
  for (FakeControl* control : {&focus_, &node_.controls[V4L2_CID_FOCUS_AUTO]}) {
    rig_ = Hardware();
    control->refusal = EBUSY;
    system_.on_sleep = [&, ready_ns = system_.now_ns() + 700 * kMs] {
      if (system_.now_ns() >= ready_ns) control->refusal = 0;
    };
    EXPECT_EQ(open().move_to(200).position, 200);
    node_.refusals = {{VIDIOC_G_CTRL, EBUSY}};
    system_.on_sleep = [&] { node_.refusals.clear(); };
    EXPECT_EQ(rig_.lens->position(), 200);
    focus_.value = 100;
  }
}

TEST_F(V4l2Lens, UnpluggedIsLost) {
  Lens& lens = open();
  node_.is_unplugged = true;
  expect_error(ErrorCode::device_lost, [&] { lens.move_to(200); });
  expect_error(ErrorCode::device_lost, [&] { lens.position(); });
}

TEST_F(V4l2Lens, AStopOnTheWayEndsItWhereTheLensIs) {
  Lens& lens = open({{"speed", "10"}});
  const std::int64_t before_ns = system_.now_ns();
  system_.on_sleep = [&] {
    if (system_.now_ns() >= before_ns + 2000 * kMs) requests_ = 1;
  };
  expect_error(ErrorCode::cancelled, [&] { lens.move_to(200); });
  EXPECT_LE(system_.now_ns(), before_ns + 2100 * kMs);
  EXPECT_EQ(ways(), (std::vector{200, 120}));
  EXPECT_EQ(lens.move_to(125).position, 125) << "the way back is not stopped by the same request";
}

TEST_F(V4l2Lens, AStopWhileSettlingDoesNotLeaveTheLensOnItsWay) {
  Lens& lens = open({{"settle_ms", "50000"}});
  const std::int64_t before_ns = system_.now_ns();
  system_.on_sleep = [&] { requests_ = 1; };
  expect_error(ErrorCode::cancelled, [&] { lens.move_to(200); });
  EXPECT_GE(system_.now_ns(), before_ns + 300 * kMs);
  EXPECT_LE(system_.now_ns(), before_ns + 400 * kMs);
}

TEST_F(V4l2Lens, ASubDeviceIsALens) {
  FakeNode& subdevice = system_.add("/dev/v4l-subdev3");
  subdevice.is_subdevice = true;
  subdevice.controls = {{V4L2_CID_FOCUS_ABSOLUTE, {"Focus, Absolute", 0, 1023, 1, 10}}};
  const Hardware rig = open_v4l2(system_, {{"lens", "/dev/v4l-subdev3"}});
  ASSERT_NE(rig.camera, nullptr);
  EXPECT_EQ(rig.lens->info().highest, 1023);
  EXPECT_EQ(rig.lens->move_to(700).position, 700);
  EXPECT_EQ(subdevice.controls[V4L2_CID_FOCUS_ABSOLUTE].value, 700);
  EXPECT_EQ(focus_.value, 100);

  const Hardware alone = open_v4l2(system_, {{"device", "/dev/v4l-subdev3"}});
  EXPECT_EQ(alone.camera, nullptr);
  EXPECT_EQ(alone.lens->position(), 700);
}

TEST_F(V4l2Lens, WithoutFocusThereIsNone) {
  node_.controls.erase(V4L2_CID_FOCUS_ABSOLUTE);
  EXPECT_EQ(open_v4l2(system_).lens, nullptr);
  expect_error(ErrorCode::unsupported,
               [&] {
                 open_v4l2(system_, {{"lens", "/dev/video0"}});
               },
               {"no focus"});
}

}  // namespace
}  // namespace fathom::test
