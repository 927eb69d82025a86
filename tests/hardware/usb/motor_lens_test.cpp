// SPDX-License-Identifier: Apache-2.0
// The motor behind the GPIO bridge moves the camera's lens. Run by usb_devices with --motor-lens
// --motor-start 0 --motor-rate 100000 --best 35 --blur 0.1 --latency 3.
#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <thread>

#include "gpio_client.hpp"
#include "stepper.hpp"
#include "video_client.hpp"

namespace fathom::usb {
namespace {

constexpr int width = 256, height = 240, best = 35;

struct UsbMotorLens : testing::Test {
  void SetUp() override {
    ASSERT_TRUE(lines.opened());
    video.set(V4L2_CID_FOCUS_AUTO, 0);
    video.set(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL);
    video.set(V4L2_CID_EXPOSURE_ABSOLUTE, 100);
  }
  void go(int steps) {
    lines.set(1, steps > 0);
    for (int i = 0; i < std::abs(steps); ++i) {
      lines.set(0, true);
      std::this_thread::sleep_for(std::chrono::milliseconds(8));
      lines.set(0, false);
      std::this_thread::sleep_for(std::chrono::milliseconds(8));
    }
  }
  GpioClient lines{{Stepper::step, Stepper::direction}, GPIO_V2_LINE_FLAG_OUTPUT};
  VideoClient video{std::getenv("FATHOM_VIDEO"), V4L2_PIX_FMT_GREY, width, height};
};

double now_s() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();  // CLOCK_MONOTONIC.
  return std::chrono::duration<double>(now).count();
}

// A client that believes the first frame after a move has one that was exposed before its end.
TEST_F(UsbMotorLens, IsSeenAsItWasSomeFramesAgo) {
  go(best);
  int seen = 0, sharper = 0;
  for (int attempt = 0; attempt < 6; ++attempt) {
    const double sharp = sharpness(video.fresh().bytes, width);
    go(-12);
    const double end_s = now_s();
    VideoFrame frame = *video.next();
    while (frame.time_s < end_s) frame = *video.next();
    const double blurred = sharpness(video.fresh().bytes, width);
    ASSERT_LT(blurred, 0.6 * sharp);
    // Three frames, 100 ms, ago the lens was six steps nearer, half as blurred.
    if (frame.time_s < end_s + 0.04) {
      ++seen;
      sharper += sharpness(frame.bytes, width) > 1.1 * blurred;
    }
    go(12);
  }
  // Not every time: on a busy machine a move can end late.
  EXPECT_GT(2 * sharper, seen) << seen;
}

}  // namespace
}  // namespace fathom::usb
