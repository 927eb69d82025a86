// SPDX-License-Identifier: Apache-2.0
// What goes wrong with a camera: damage, losses, a stall, an unplugging, another program.
#include <gtest/gtest.h>

#include "support.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

class V4l2Faults : public testing::Test {
 protected:
  Camera& open() {
    rig_ = Hardware();
    rig_ = open_v4l2(system_, {}, {.camera = true, .lens = false});
    return *rig_.camera;
  }

  FakeSystem system_;
  FakeNode& node_ = add_webcam(system_);
  Hardware rig_;
};

TEST_F(V4l2Faults, DamagedAndShortBuffersAreCountedAndNotGivenOut) {
  node_.on_frame = [](v4l2_buffer& buffer, std::vector<std::uint8_t>&) {
    if (buffer.sequence % 3 == 0) buffer.flags |= V4L2_BUF_FLAG_ERROR;
    if (buffer.sequence % 3 == 1) buffer.bytesused -= 1;
  };
  Camera& camera = open();
  for (int i = 0; i < 5; ++i) {
    const auto frame = camera.grab(1s);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->at(0, 0) % 256 % 3, 2U);  // the fake's frames are filled with their number
  }
  EXPECT_EQ(camera.counts(), (FrameCounts{5, 0, 10}));
}

TEST_F(V4l2Faults, LyingAboutTheSizeReadsNothingBeyondTheBuffer) {
  node_.on_frame = [](v4l2_buffer& buffer, std::vector<std::uint8_t>&) {
    buffer.bytesused = 0xffffffffU;
  };
  EXPECT_TRUE(open().grab(1s));
}

TEST_F(V4l2Faults, NothingButDamageEndsAtTheTimeout) {
  node_.on_frame = [](v4l2_buffer& buffer, std::vector<std::uint8_t>&) {
    buffer.flags |= V4L2_BUF_FLAG_ERROR;
  };
  Camera& camera = open();
  const std::int64_t before_ns = system_.now_ns();
  EXPECT_FALSE(camera.grab(1s));
  EXPECT_GE(system_.now_ns(), before_ns + 1000 * kMs);
  EXPECT_LE(system_.now_ns(), before_ns + 1100 * kMs);
  EXPECT_GE(camera.counts().corrupt, 20U);
}

TEST_F(V4l2Faults, LostFramesAreCounted) {
  Camera& camera = open();
  ASSERT_TRUE(camera.grab(1s));
  node_.skip_sequence(3);
  ASSERT_TRUE(camera.grab(1s));
  EXPECT_EQ(camera.counts(), (FrameCounts{2, 3, 0}));
}

/// As uvcvideo throws away a damaged frame: its buffer goes to the end of the queue.
TEST_F(V4l2Faults, LossesOfADriverThatTurnsItsBuffersRoundAreCounted) {
  Camera& camera = open();
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(camera.grab(1s));
    node_.throw_away(3);
  }
  ASSERT_TRUE(camera.grab(1s));
  EXPECT_EQ(camera.counts(), (FrameCounts{4, 9, 0}));
}

TEST_F(V4l2Faults, LossesAreKeptWhenTheStreamRestarts) {
  Camera& camera = open();
  ASSERT_TRUE(camera.grab(1s));
  node_.skip_sequence(3);
  ASSERT_TRUE(camera.grab(1s));
  camera.apply({64, 48, Depth::bits8, 10});
  ASSERT_TRUE(camera.grab(1s));
  EXPECT_EQ(camera.counts(), (FrameCounts{3, 3, 0}));
}

TEST_F(V4l2Faults, AStallIsNothingAtTheTimeout) {
  Camera& camera = open();
  ASSERT_TRUE(camera.grab(1s));
  node_.is_stalled = true;
  const std::int64_t before_ns = system_.now_ns();
  EXPECT_FALSE(camera.grab(700ms));
  EXPECT_EQ(system_.now_ns(), before_ns + 700 * kMs);
  EXPECT_FALSE(camera.grab(0ms));
  EXPECT_EQ(system_.now_ns(), before_ns + 700 * kMs);
  node_.is_stalled = false;
  EXPECT_TRUE(camera.grab(1s));
}

TEST_F(V4l2Faults, ATimeoutBeyondTheClockIsAnEndlessOne) {
  Camera& camera = open();
  EXPECT_TRUE(camera.grab(std::chrono::milliseconds::max()));
  EXPECT_FALSE(camera.grab(std::chrono::milliseconds::min()));
}

TEST_F(V4l2Faults, ADriverThatPromisesAFrameAndHasNoneEndsAtTheTimeout) {
  Camera& camera = open();
  node_.refusals = {{VIDIOC_DQBUF, EAGAIN}};
  node_.run_to(system_.now_ns() + 100 * kMs);  // there is one
  EXPECT_FALSE(camera.grab(0ms));
}

TEST_F(V4l2Faults, AStopEndsAWait) {
  int requests = 0;
  const OpenOptions options{
      .camera = true, .lens = false, .stop_requests = [&] { return requests; }};
  rig_ = open_v4l2(system_, {}, options);
  node_.is_stalled = true;
  const std::int64_t before_ns = system_.now_ns();
  system_.on_sleep = [&] {
    if (system_.now_ns() > before_ns + 900 * kMs) requests = 1;
  };
  expect_error(ErrorCode::cancelled, [&] { rig_.camera->grab(60s); });
  EXPECT_LE(system_.now_ns(), before_ns + 1200 * kMs);
  node_.is_stalled = false;
  EXPECT_TRUE(rig_.camera->grab(1s)) << "a request of before does not end what begins now";
}

TEST_F(V4l2Faults, UnpluggingIsAnErrorAtOnceAndEveryTime) {
  Camera& camera = open();
  ASSERT_TRUE(camera.grab(1s));
  node_.is_unplugged = true;
  const std::int64_t before_ns = system_.now_ns();
  for (int i = 0; i < 2; ++i) {
    expect_error(ErrorCode::device_lost, [&] { camera.grab(5s); }, {"/dev/video0", "unplugged"});
  }
  EXPECT_EQ(system_.now_ns(), before_ns);
}

TEST_F(V4l2Faults, AnUnpluggingInMidWaitIsNoticed) {
  Camera& camera = open();
  node_.is_stalled = true;
  system_.on_sleep = [&] { node_.is_unplugged = true; };
  expect_error(ErrorCode::device_lost, [&] { camera.grab(5s); });
}

TEST_F(V4l2Faults, WhatIsPluggedInAgainIsOpenedAgain) {
  Camera& camera = open();
  node_.is_unplugged = true;
  expect_error(ErrorCode::device_lost, [&] { camera.grab(1s); });
  node_.is_unplugged = false;
  // The old camera is still there and keeps the old node; the new one must have a node of its own.
  const Hardware again = open_v4l2(system_, {}, {.camera = false, .lens = true});
  EXPECT_EQ(node_.times_opened, 2);
  rig_ = Hardware();
  EXPECT_TRUE(open().grab(1s));
}

TEST_F(V4l2Faults, AStreamThatBreaksIsLost) {
  Camera& camera = open();
  node_.is_broken = true;
  node_.is_stalled = true;
  expect_error(ErrorCode::device_lost, [&] { camera.grab(1s); }, {"stream broke"});
  node_.is_broken = node_.is_stalled = false;
  // Its driver gives frames again, but which and since when?
  expect_error(ErrorCode::device_lost, [&] { camera.grab(1s); }, {"stream broke"});
  expect_error(ErrorCode::device_lost, [&] {
    camera.apply({64, 48, Depth::bits8, camera.settings().exposure_ms});
  });
  EXPECT_TRUE(open().grab(1s));
}

/// As videobuf2 says it of a stream in error: not by poll() but by the buffer.
TEST_F(V4l2Faults, ABufferThatCannotBeTakenIsLostEveryTime) {
  Camera& camera = open();
  node_.refusals = {{VIDIOC_DQBUF, EIO}};
  expect_error(ErrorCode::device_lost, [&] { camera.grab(1s); }, {"stream broke"});
  node_.refusals.clear();
  expect_error(ErrorCode::device_lost, [&] { camera.grab(1s); }, {"stream broke"});
  EXPECT_TRUE(open().grab(1s));
}

TEST_F(V4l2Faults, ACameraInUseIsUnavailableAndIsNotTouched) {
  for (const unsigned long request : {VIDIOC_S_FMT, VIDIOC_REQBUFS, VIDIOC_STREAMON}) {
    node_.refusals = {{request, EBUSY}};
    node_.written.clear();
    expect_error(ErrorCode::unavailable, [&] { open(); }, {"/dev/video0", "in use"});
    EXPECT_EQ(node_.mapped, 0);
    EXPECT_EQ(node_.open_count, 0);
    EXPECT_EQ(node_.controls[V4L2_CID_EXPOSURE_AUTO].value, V4L2_EXPOSURE_APERTURE_PRIORITY);
    EXPECT_EQ(node_.written.empty(), request == VIDIOC_S_FMT);
  }
  node_.refusals.clear();
  EXPECT_TRUE(open().grab(1s));
}

/// There is nothing to put back, so the message does not wait for that.
TEST_F(V4l2Faults, ACameraInUseIsSaidToBeAtOnce) {
  node_.refusals = {{VIDIOC_S_FMT, EBUSY}, {VIDIOC_S_PARM, EBUSY}};
  const std::int64_t before_ns = system_.now_ns();
  expect_error(ErrorCode::unavailable, [&] { open(); }, {"in use"});
  EXPECT_EQ(system_.now_ns(), before_ns);
}

TEST_F(V4l2Faults, WithoutBandwidthItSaysWhatToTry) {
  node_.refusals = {{VIDIOC_STREAMON, ENOSPC}};
  expect_error(ErrorCode::unavailable, [&] { open(); }, {"bandwidth", "smaller"});
}

TEST_F(V4l2Faults, WhatCannotBeOpenedSaysWhatToDo) {
  const std::pair<int, const char*> refusals[] = {
      {EACCES, "group video"}, {EBUSY, "in use"}, {ENODEV, "plugged in"}, {EMFILE, "Too many"}};
  for (const auto& [error, text] : refusals) {
    node_.open_error = error;
    expect_error(ErrorCode::unavailable, [&] { open(); }, {"/dev/video0", text});
  }
  expect_error(ErrorCode::unavailable,
               [&] {
                 open_v4l2(system_, {{"device", "/dev/video7"}});
               },
               {"rigs list"});
  expect_error(ErrorCode::bad_argument,
               [&] {
                 open_v4l2(system_, {{"device", ""}});
               },
               {"v4l2:/dev/video0"});
}

TEST_F(V4l2Faults, ANodeOfMetadataIsNoCamera) {
  node_.capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  expect_error(ErrorCode::unsupported, [&] { open(); }, {"no pictures"});
}

TEST_F(V4l2Faults, AMultiPlanarNodeIsSaidNotToBeSupported) {
  node_.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  expect_error(ErrorCode::unsupported, [&] { open(); }, {"/dev/video0", "multi-planar"});
  node_.capabilities |= V4L2_CAP_VIDEO_CAPTURE;
  EXPECT_TRUE(open().grab(1s));
}

TEST_F(V4l2Faults, SignalsInterruptNothing) {
  system_.interruptions = 1;
  Camera& camera = open();
  for (int i = 0; i < 20; ++i) {
    system_.interruptions = i;
    EXPECT_TRUE(camera.grab(1s)) << i;
  }
}

}  // namespace
}  // namespace fathom::test
