// SPDX-License-Identifier: Apache-2.0
// The simulated camera, seen through the stock driver. Run by usb_devices (FATHOM_VIDEO) with
// --best 350 --focus-speed 4000.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <system_error>
#include <thread>

#include "commands.hpp"
#include "video_client.hpp"

namespace fathom::usb {
namespace {

constexpr int width = 256, height = 240;
constexpr int best_focus = 350;

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

void tell(const std::string& line) {
  ASSERT_EQ(command(environment("FATHOM_USB_SOCKET"), line), "ok") << line;
}

void wait_ms(int time) { std::this_thread::sleep_for(std::chrono::milliseconds(time)); }

void all_manual(VideoClient& video) {
  video.set(V4L2_CID_FOCUS_AUTO, 0);
  video.set(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL);
  video.set(V4L2_CID_AUTO_WHITE_BALANCE, 0);
  video.set(V4L2_CID_EXPOSURE_ABSOLUTE, 100);
}

struct UsbCamera : testing::Test {
  VideoClient video{environment("FATHOM_VIDEO"), V4L2_PIX_FMT_GREY, width, height};
};

// Before any other: as it is when plugged in.
TEST_F(UsbCamera, MovesItsFocusAndExposureByItselfUntilToldNotTo) {
  const auto spread = [&](std::uint32_t control) {
    int least = video.get(control), most = least;
    for (int i = 0; i < 20; ++i) {
      wait_ms(50);
      least = std::min(least, video.get(control));
      most = std::max(most, video.get(control));
    }
    return most - least;
  };
  EXPECT_GT(spread(V4L2_CID_FOCUS_ABSOLUTE), 100);
  EXPECT_GT(spread(V4L2_CID_EXPOSURE_ABSOLUTE), 20);
  EXPECT_THROW(video.set(V4L2_CID_FOCUS_ABSOLUTE, 10), std::system_error);
  all_manual(video);
  video.set(V4L2_CID_FOCUS_ABSOLUTE, 10);
  EXPECT_EQ(spread(V4L2_CID_FOCUS_ABSOLUTE), 0);
  EXPECT_EQ(spread(V4L2_CID_EXPOSURE_ABSOLUTE), 0);
}

TEST_F(UsbCamera, IsSharpestWhereItWasMadeSharpest) {
  all_manual(video);
  std::map<int, double> curve;
  for (int focus = 50; focus < 1000; focus += 100) {
    video.set(V4L2_CID_FOCUS_ABSOLUTE, focus);
    wait_ms(100);
    curve[focus] = sharpness(video.fresh().bytes, width);
  }
  for (int focus = 50; focus < 900; focus += 100) {
    if (focus + 100 <= best_focus) {
      EXPECT_LT(curve[focus], curve[focus + 100]) << focus;
    } else {
      EXPECT_GT(curve[focus], curve[focus + 100]) << focus;
    }
  }
  EXPECT_GT(curve[best_focus], 5 * curve[best_focus + 300]);
}

TEST_F(UsbCamera, ShowsALensThatIsStillOnItsWayAsBlurred) {
  all_manual(video);
  video.set(V4L2_CID_FOCUS_ABSOLUTE, best_focus);
  wait_ms(100);
  const double sharp = sharpness(video.fresh().bytes, width);
  video.set(V4L2_CID_FOCUS_ABSOLUTE, 1000);
  wait_ms(400);
  video.fresh();
  video.set(V4L2_CID_FOCUS_ABSOLUTE, best_focus);  // 160 ms on its way.
  EXPECT_LT(sharpness(video.next()->bytes, width), 0.8 * sharp);
  wait_ms(300);
  EXPECT_NEAR(sharpness(video.fresh().bytes, width), sharp, 0.01 * sharp);
}

TEST_F(UsbCamera, GetsBrighterWithExposureAndGain) {
  all_manual(video);
  video.set(V4L2_CID_GAIN, 16);
  const double usual = mean(video.fresh().bytes);
  video.set(V4L2_CID_EXPOSURE_ABSOLUTE, 50);
  EXPECT_NEAR(mean(video.fresh().bytes), usual / 2, 1);
  video.set(V4L2_CID_GAIN, 32);
  EXPECT_NEAR(mean(video.fresh().bytes), usual, 1);
  video.set(V4L2_CID_GAIN, 16);
}

// By default the driver keeps damaged frames to itself: their numbers are missing.
TEST_F(UsbCamera, LosesCorruptAndShortFrames) {
  const auto missing = [&](const char* how) {
    const std::uint32_t first = video.fresh().sequence;
    tell(how);
    constexpr int taken = 12;
    std::uint32_t last = first;
    for (int i = 0; i < taken; ++i) last = video.next()->sequence;
    return static_cast<int>(last - first) - taken;
  };
  EXPECT_EQ(missing("camera corrupt 3"), 3);
  EXPECT_EQ(missing("camera shorten 2"), 2);
  EXPECT_EQ(missing("camera drop 2"), 0);
}

TEST_F(UsbCamera, StallsAndResumes) {
  video.fresh();
  tell("camera stall");
  while (video.next(500)) {
  }
  EXPECT_FALSE(video.next(500));
  tell("camera resume");
  EXPECT_TRUE(video.next());
}

TEST_F(UsbCamera, RefusesAControlRequest) {
  all_manual(video);
  tell("camera refuse 1");
  EXPECT_THROW(video.set(V4L2_CID_FOCUS_ABSOLUTE, 77), std::system_error);
  video.set(V4L2_CID_FOCUS_ABSOLUTE, 78);
  EXPECT_EQ(video.get(V4L2_CID_FOCUS_ABSOLUTE), 78);
}

TEST_F(UsbCamera, ClampsItsFocusInSilence) {
  all_manual(video);
  tell("camera clamp 100 500");
  video.set(V4L2_CID_FOCUS_ABSOLUTE, 800);
  EXPECT_EQ(video.get(V4L2_CID_FOCUS_ABSOLUTE), 500);
  tell("camera clamp 0 1000");
}

void plug_again() {
  const std::string device = environment("FATHOM_VIDEO");
  tell("camera unplug");
  for (int i = 0; i < 100 && std::filesystem::exists(device); ++i) wait_ms(50);
  tell("camera plug");
  for (int i = 0; i < 100 && !std::filesystem::exists(device); ++i) wait_ms(50);
  wait_ms(200);
}

TEST(UsbCameraPlug, IsGoneWhenUnpluggedAndBackWhenPluggedIn) {
  const std::string device = environment("FATHOM_VIDEO");
  {
    VideoClient video(device, V4L2_PIX_FMT_GREY, width, height);
    video.fresh();
    tell("camera unplug");
    EXPECT_THROW(for (int i = 0; i < 100; ++i) video.next(100), std::system_error);
  }
  plug_again();
  VideoClient video(device, V4L2_PIX_FMT_GREY, width, height);
  EXPECT_EQ(video.fresh().bytes.size(), std::size_t{width * height});
}

TEST(UsbCameraPlug, MarksDamagedFramesWhereTheDriverGivesThemOut) {
  const char* const parameter = "/sys/module/uvcvideo/parameters/nodrop";
  std::ofstream(parameter) << 1;
  plug_again();  // The driver looks at its parameter only now.
  const auto damaged = [](const char* how) {
    VideoClient video(environment("FATHOM_VIDEO"), V4L2_PIX_FMT_GREY, width, height);
    video.fresh();
    tell(how);
    int count = 0;
    for (int i = 0; i < 12; ++i) count += video.next()->error;
    return count;
  };
  EXPECT_EQ(damaged("camera corrupt 3"), 3);
  EXPECT_EQ(damaged("camera shorten 2"), 2);
  EXPECT_EQ(damaged("camera drop 2"), 0);
  std::ofstream(parameter) << 0;
}

TEST(UsbCameraFormats, HaveTheirBytes) {
  struct {
    std::uint32_t fourcc;
    std::size_t bytes;
  } const formats[] = {{V4L2_PIX_FMT_YUYV, width * height * 2},
                       {V4L2_PIX_FMT_Y16, width * height * 2},
                       {V4L2_PIX_FMT_Y10, width * height * 2},
                       {V4L2_PIX_FMT_Y12, width * height * 2},
                       {V4L2_PIX_FMT_NV12, width * height * 3 / 2}};
  for (const auto& format : formats) {
    VideoClient video(environment("FATHOM_VIDEO"), format.fourcc, width, height);
    EXPECT_EQ(video.next()->bytes.size(), format.bytes) << format.fourcc;
  }
  VideoClient video(environment("FATHOM_VIDEO"), V4L2_PIX_FMT_MJPEG, width, height);
  const auto jpeg = video.next()->bytes;
  ASSERT_GT(jpeg.size(), 1000u);
  EXPECT_EQ(jpeg[0], 0xff);
  EXPECT_EQ(jpeg[1], 0xd8);
}

}  // namespace
}  // namespace fathom::usb
