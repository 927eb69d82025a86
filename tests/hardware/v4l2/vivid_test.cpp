// SPDX-License-Identifier: Apache-2.0
// The driver on vivid, the kernel's test driver, which makes faults on demand: needs
//   with_vivid vivid_test
#include <linux/videodev2.h>

#include "main.hpp"
#include "support.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

/// Of the inputs that with_vivid makes: a webcam with sizes of its own, HDMI with any size.
constexpr const char* kWebcam = "0";
constexpr const char* kHdmi = "1";

class Vivid : public testing::Test {
 protected:
  std::unique_ptr<Camera> open(std::map<std::string, std::string> keys = {}) {
    keys.emplace("device", device_);
    keys.emplace("input", kHdmi);
    keys.emplace("width", keys.at("input") == kHdmi ? "256" : "320");
    keys.emplace("height", keys.at("input") == kHdmi ? "240" : "180");
    return std::move(open_v4l2(std::move(keys), {.camera = true, .lens = false}).camera);
  }
  void inject(const std::string& name, int value = 1) { set_control(device_, name, value); }

  const std::string device_ = device_file("FATHOM_VIVID");
};

TEST_F(Vivid, GivesWhatIsAskedFor) {
  for (const auto& [format, depth] : {std::pair{"GREY", Depth::bits8},
                                      {"YUYV", Depth::bits8},
                                      {"NV12", Depth::bits8},
                                      {"Y16", Depth::bits16}}) {
    const auto camera = open({{"format", format}});
    const auto frame = camera->grab(5s);
    ASSERT_TRUE(frame) << format;
    EXPECT_EQ(frame->width_px(), 256);
    EXPECT_EQ(frame->height_px(), 240);
    EXPECT_EQ(frame->depth(), depth) << format;
  }
}

TEST_F(Vivid, ASizeThatAWebcamHasNotIsAdjustedOrRefused) {
  expect_error(ErrorCode::unsupported,
               [&] {
                 open({{"input", kWebcam}, {"width", "256"}, {"height", "240"}});
               },
               {"width=320,height=180"});
  const auto camera = open({{"input", kWebcam}, {"fps", "25"}});
  CameraSettings wished = camera->settings();
  wished.width_px = 256, wished.height_px = 240;
  EXPECT_EQ(camera->validate(wished), Validity::adjusted);
  EXPECT_EQ(wished.width_px, 320);
  EXPECT_TRUE(camera->grab(5s));
}

TEST_F(Vivid, AutomaticGainIsOffWhileOpen) {
  set_control(device_, "Gain, Automatic", 1);
  {
    const auto camera = open();
    EXPECT_EQ(get_control(device_, V4L2_CID_AUTOGAIN), 0);
  }
  EXPECT_EQ(get_control(device_, V4L2_CID_AUTOGAIN), 1);
}

TEST_F(Vivid, StampsOfBothKindsAreEarlyAndInOrder) {
  for (const int source : {0, 1}) {  // end of frame, start of exposure
    inject("Timestamp Source", source);
    const auto camera = open();
    std::int64_t last_ns = 0;
    for (int i = 0; i < 5; ++i) {
      const auto frame = camera->grab(5s);
      ASSERT_TRUE(frame);
      EXPECT_GT(frame->exposure.start_ns, last_ns);
      EXPECT_GE(frame->exposure.end_ns, frame->exposure.start_ns);
      last_ns = frame->exposure.start_ns;
    }
  }
  inject("Timestamp Source", 0);
}

TEST_F(Vivid, DroppedBuffersAreCounted) {
  const auto camera = open();
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(camera->grab(5s));
  EXPECT_EQ(camera->counts().dropped, 0U);
  inject("Percentage of Dropped Buffers", 50);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(camera->grab(5s));
  inject("Percentage of Dropped Buffers", 0);
  EXPECT_GE(camera->counts().dropped, 4U);
  EXPECT_EQ(camera->counts().delivered, 25U);
}

TEST_F(Vivid, ADamagedBufferIsCountedAndNotGivenOut) {
  const auto camera = open();
  ASSERT_TRUE(camera->grab(5s));
  inject("Inject V4L2_BUF_FLAG_ERROR");
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(camera->grab(5s));
  EXPECT_EQ(camera->counts().corrupt, 1U);
}

TEST_F(Vivid, AStreamThatDoesNotStartIsAnErrorAndLeavesNothingBehind) {
  set_control(device_, "Gain, Automatic", 1);
  for (const char* fault : {"Inject VIDIOC_STREAMON Error", "Inject VIDIOC_REQBUFS Error"}) {
    inject(fault);
    expect_error(ErrorCode::io, [&] { open(); }, {device_.c_str()});
    EXPECT_EQ(get_control(device_, V4L2_CID_AUTOGAIN), 1);
    EXPECT_TRUE(open()->grab(5s));
  }
}

TEST_F(Vivid, AQueueThatBreaksIsLostAndCanBeOpenedAgain) {
  auto camera = open();
  ASSERT_TRUE(camera->grab(5s));
  inject("Inject Fatal Streaming Error");
  const auto waited = time_of([&] {
    expect_error(ErrorCode::device_lost, [&] {
      while (camera->grab(5s)) {
      }
    });
  });
  EXPECT_LT(waited, 5s);
  camera = nullptr;
  EXPECT_TRUE(open()->grab(5s));
}

TEST_F(Vivid, ACameraInUseIsUnavailable) {
  const auto camera = open();
  expect_error(ErrorCode::unavailable, [&] { open(); }, {"in use"});
  EXPECT_TRUE(camera->grab(5s));
}

/// Last: vivid stays away until it is loaded again.
TEST_F(Vivid, ZDisconnectingIsLost) {
  const auto camera = open();
  ASSERT_TRUE(camera->grab(5s));
  inject("Disconnect");
  const auto waited = time_of([&] {
    expect_error(ErrorCode::device_lost, [&] {
      while (camera->grab(5s)) {
      }
    });
  });
  EXPECT_LT(waited, 5s);
}

}  // namespace
}  // namespace fathom::test

int main(int argc, char** argv) {
  return fathom::test::run_on_device(argc, argv, "FATHOM_VIVID", "driver vivid");
}
