// SPDX-License-Identifier: Apache-2.0
// The camera on a made-up system: what is chosen, checked, set and counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

class V4l2Camera : public testing::Test {
 protected:
  Camera& open(std::map<std::string, std::string> keys = {}) {
    rig_ = Hardware();
    rig_ = open_v4l2(system_, std::move(keys));
    return *rig_.camera;
  }

  FakeSystem system_;
  FakeNode& node_ = add_webcam(system_);
  Hardware rig_;
};

TEST_F(V4l2Camera, TakesTheDeepestGreyOfTheSizeThatTheDeviceStandsAt) {
  EXPECT_EQ(open().settings(), (CameraSettings{32, 24, Depth::bits16, 25}));
  EXPECT_EQ(node_.format.pixelformat, V4L2_PIX_FMT_Y16);
  EXPECT_NE(rig_.camera->description().find("Fake camera"), std::string::npos);
  EXPECT_TRUE(rig_.camera->is_live());
}

TEST_F(V4l2Camera, TheSizeAskedForGoesBeforeTheFormat) {
  EXPECT_EQ(open({{"width", "64"}, {"height", "48"}}).settings().depth, Depth::bits8);
  EXPECT_EQ(node_.format.pixelformat, V4L2_PIX_FMT_YUYV);
}

TEST_F(V4l2Camera, ASideThatIsNotAskedForFollowsTheOther) {
  EXPECT_EQ(open({{"width", "64"}}).settings().height_px, 48);
  EXPECT_EQ(open({{"height", "12"}}).settings().width_px, 16);
}

TEST_F(V4l2Camera, TheRateAskedForGoesBeforeTheFormat) {
  node_.formats[1].fps = 5;  // GREY
  node_.formats[2].fps = 2;  // Y16
  open({{"fps", "50"}});
  EXPECT_EQ(node_.format.pixelformat, V4L2_PIX_FMT_YUYV);
  EXPECT_EQ(node_.interval_ns, 20 * kMs);
}

TEST_F(V4l2Camera, TheFormatAskedForIsTaken) {
  open({{"format", "GREY"}});
  EXPECT_EQ(node_.format.pixelformat, V4L2_PIX_FMT_GREY);
  expect_error(ErrorCode::unsupported,
               [&] {
                 open({{"format", "MJPEG"}});
               },
               {"/dev/video0", "MJPEG", "YUYV"});
  expect_error(ErrorCode::bad_argument, [&] { open({{"format", "H264"}}); }, {"format", "GREY"});
}

TEST_F(V4l2Camera, WithoutAFormatThatIsReadItSaysWhatThereIs) {
  node_.formats = {{V4L2_PIX_FMT_H264, {{64, 48}}}};
  expect_error(ErrorCode::unsupported, [&] { open(); }, {"H264", "GREY"});
}

TEST_F(V4l2Camera, WhatARigFileAsksForAndCannotHaveIsRefusedWithTheNearest) {
  expect_error(ErrorCode::unsupported, [&] { open({{"width", "60"}}); }, {"width=64", "height=48"});
  expect_error(ErrorCode::unsupported, [&] { open({{"exposure_ms", "900"}}); }, {"204.7"});
  expect_error(ErrorCode::unsupported,
               [&] {
                 open({{"exposure_ms", "20.04"}});
               },
               {"nearest is 20"});
  expect_error(ErrorCode::unsupported, [&] { open({{"gain", "61"}}); }, {"nearest is 60"});
  expect_error(ErrorCode::unsupported, [&] { open({{"fps", "1000"}}); }, {"100.000"});
  expect_error(ErrorCode::unsupported, [&] { open({{"input", "3"}}); }, {"no input 3"});
  node_.controls.erase(V4L2_CID_GAIN);
  node_.controls.erase(V4L2_CID_EXPOSURE_ABSOLUTE);
  expect_error(ErrorCode::unsupported, [&] { open({{"gain", "60"}}); }, {"no gain"});
  expect_error(ErrorCode::unsupported, [&] { open({{"exposure_ms", "5"}}); }, {"exposure_ms"});
  EXPECT_EQ(open().settings().exposure_ms, 0);
}

TEST_F(V4l2Camera, WhatARigFileAsksForIsSet) {
  open({{"exposure_ms", "33.3"}, {"gain", "65"}, {"fps", "50"}, {"buffers", "7"}});
  EXPECT_EQ(node_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value, 333);
  EXPECT_EQ(node_.controls[V4L2_CID_GAIN].value, 65);
  EXPECT_EQ(node_.interval_ns, 20 * kMs);
  EXPECT_EQ(node_.mapped, 7);
  EXPECT_EQ(rig_.camera->settings().exposure_ms, 33.3);
}

TEST_F(V4l2Camera, AnExposureThatIsClampedInSilenceIsNotBelieved) {
  node_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].becomes = [](std::int32_t value) {
    return std::min(value, 100);
  };
  expect_error(ErrorCode::unsupported, [&] { open({{"exposure_ms", "20"}}); }, {"nearest is 10"});
}

TEST_F(V4l2Camera, ValidationDoesNotDisturbTheStream) {
  for (const bool lists_sizes : {true, false}) {
    node_.lists_sizes = lists_sizes;
    Camera& camera = open();
    ASSERT_TRUE(camera.grab(1s));
    node_.requests.clear();
    CameraSettings wished{1000, 1000, Depth::bits8, 1e9};
    EXPECT_EQ(camera.validate(wished), Validity::adjusted);
    EXPECT_EQ(wished, (CameraSettings{64, 48, Depth::bits8, 204.7}));
    EXPECT_EQ(camera.validate(wished), Validity::valid);
    wished = {17, 13, Depth::bits16, 10};
    EXPECT_EQ(camera.validate(wished), Validity::adjusted);
    EXPECT_EQ(wished, (CameraSettings{16, 12, Depth::bits16, 10}));
    const auto asked = [&](unsigned long request) {
      return std::count(node_.requests.begin(), node_.requests.end(), request);
    };
    EXPECT_EQ(asked(VIDIOC_TRY_FMT) > 0, !lists_sizes) << "it reaches into a USB camera";
    EXPECT_EQ(asked(VIDIOC_S_FMT) + asked(VIDIOC_STREAMOFF) + asked(VIDIOC_S_CTRL), 0);
  }
}

TEST_F(V4l2Camera, MeaninglessWishesAreRefused) {
  Camera& camera = open();
  for (const CameraSettings& wish :
       {CameraSettings{0, 24, Depth::bits16, 25}, CameraSettings{32, -1, Depth::bits16, 25},
        CameraSettings{32, 24, Depth::bits16, -1}, CameraSettings{32, 24, Depth::bits16, NAN}}) {
    CameraSettings changed = wish;
    EXPECT_EQ(camera.validate(changed), Validity::refused);
    expect_error(ErrorCode::unsupported, [&] { camera.apply(wish); });
  }
}

TEST_F(V4l2Camera, ApplyRestartsTheStreamInTheNewSize) {
  Camera& camera = open();
  camera.apply(camera.settings());
  EXPECT_EQ(node_.starts, 1);
  const CameraSettings wished{64, 48, Depth::bits8, 10};
  camera.apply(wished);
  EXPECT_EQ(camera.settings(), wished);
  EXPECT_EQ(node_.starts, 2);
  EXPECT_EQ(node_.mapped, 4);
  const auto frame = camera.grab(1s);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->width_px(), 64);
  expect_error(ErrorCode::unsupported, [&] { camera.apply({65, 48, Depth::bits8, 10}); });
  EXPECT_EQ(camera.settings(), wished);
}

TEST_F(V4l2Camera, AnApplyThatFailsGoesBackToWhatWas) {
  Camera& camera = open();
  const CameraSettings own = camera.settings();
  node_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].refusal = EIO;
  expect_error(ErrorCode::io, [&] { camera.apply({64, 48, Depth::bits8, 10}); });
  node_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].refusal = 0;
  EXPECT_EQ(camera.settings(), own);
  EXPECT_EQ(node_.format.pixelformat, V4L2_PIX_FMT_Y16);
}

TEST_F(V4l2Camera, HoldsTheFrameThatItGaveWhileTheDriverFillsOthers) {
  node_.buffer_flags |= V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
  Camera& camera = open({{"format", "GREY"}});
  const auto first = camera.grab(1s);
  ASSERT_TRUE(first);
  const auto grey = first->at(5, 5);
  for (int i = 0; i < 9; ++i) ASSERT_TRUE(camera.grab(1s));
  EXPECT_EQ(first->at(5, 5), grey);
}

TEST_F(V4l2Camera, AnInputIsSelectedAndPutBack) {
  node_.inputs = 2;
  open({{"input", "1"}});
  EXPECT_EQ(node_.input, 1);
  rig_ = Hardware();
  EXPECT_EQ(node_.input, 0);
}

TEST_F(V4l2Camera, FormatRateAndMemoryArePutBack) {
  open({{"width", "64"}, {"height", "48"}, {"fps", "50"}});
  rig_ = Hardware();
  EXPECT_EQ(node_.format.width, 32U);
  EXPECT_EQ(node_.format.pixelformat, V4L2_PIX_FMT_YUYV);
  EXPECT_EQ(node_.interval_ns, 40 * kMs);
  EXPECT_EQ(node_.mapped, 0);
  EXPECT_FALSE(node_.is_streaming);
  EXPECT_EQ(node_.open_count, 0);
}

TEST_F(V4l2Camera, StampsOfUvcAreNotTakenForStartsOfExposures) {
  node_.buffer_flags |= V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  const auto start_before_stamp = [&](std::map<std::string, std::string> keys) {
    std::int64_t stamp_ns = 0;
    node_.on_frame = [&](v4l2_buffer& buffer, std::vector<std::uint8_t>&) {
      if (stamp_ns == 0)
        stamp_ns = buffer.timestamp.tv_sec * 1000 * kMs + buffer.timestamp.tv_usec * 1000;
    };
    const auto frame = open(std::move(keys)).grab(1s);
    return stamp_ns - frame->exposure.start_ns;
  };
  EXPECT_EQ(start_before_stamp({}), 0);
  node_.driver = "uvcvideo";
  EXPECT_EQ(start_before_stamp({}), (25 + 80) * kMs);
  EXPECT_EQ(start_before_stamp({{"delay_frames", "0"}}), 25 * kMs);
  EXPECT_EQ(start_before_stamp({{"delay_frames", "3"}}), (25 + 120) * kMs);
}

TEST_F(V4l2Camera, FramesFromBeforeALongPauseTellTheirAge) {
  for (const std::uint32_t flags :
       {V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC, V4L2_BUF_FLAG_TIMESTAMP_COPY}) {
    node_.buffer_flags = flags;
    Camera& camera = open();
    ASSERT_TRUE(camera.grab(1s));
    const std::int64_t paused_ns = system_.now_ns();
    system_.sleep_until_ns(paused_ns + 60'000 * kMs);
    const std::int64_t resumed_ns = system_.now_ns();
    int old = 0;
    std::int64_t start_ns = 0;
    while (start_ns < resumed_ns) {
      const auto frame = camera.grab(1s);
      ASSERT_TRUE(frame);
      start_ns = frame->exposure.start_ns;
      if (start_ns < resumed_ns) ++old;
      if (old <= 4) {
        EXPECT_LT(start_ns, paused_ns + 200 * kMs);
      }
    }
    EXPECT_LE(old, 4 + 3);  // the full buffers, and frames that may have begun before
    EXPECT_LT(system_.now_ns(), resumed_ns + 300 * kMs);
    EXPECT_EQ(camera.counts().dropped, 0U);
  }
}

TEST_F(V4l2Camera, LeavesAutomaticsWhereToldTo) {
  open({{"automatics", "leave"}});
  EXPECT_EQ(node_.controls[V4L2_CID_AUTO_WHITE_BALANCE].value, 1);
  EXPECT_EQ(node_.controls[V4L2_CID_EXPOSURE_AUTO].value, V4L2_EXPOSURE_APERTURE_PRIORITY);
}

TEST_F(V4l2Camera, UnknownKeysAreNotOurs) {
  expect_error(ErrorCode::bad_argument, [&] { open({{"exposure", "3"}}); }, {"exposure_ms"});
}

}  // namespace
}  // namespace fathom::test
