// SPDX-License-Identifier: Apache-2.0
// The driver on uvcvideo, with a simulated USB camera whose lens moves: needs
//   usb_devices --camera --best 640 -- uvc_test
#include <linux/videodev2.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string_view>
#include <thread>
#include <vector>

#include "engine/error.hpp"
#include "hal/clock.hpp"
#include "main.hpp"
#include "support.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

/// As another program: this one, started with this word, opens the camera and says how that ended.
constexpr const char* kOpenOnly = "--open-only";
constexpr int kInUse = 10, kOpened = 11, kOtherwise = 12;

int open_only() {
  try {
    open_v4l2({{"device", device_file("FATHOM_VIDEO")}}, {.camera = true, .lens = false});
    return kOpened;
  } catch (const Error& error) {
    std::puts(error.what());
    return error.code() == ErrorCode::unavailable ? kInUse : kOtherwise;
  }
}

const RigDriver& v4l2() {
  for (const RigDriver* driver : all_rig_drivers()) {
    if (std::string(driver->name()) == "v4l2") return *driver;
  }
  throw std::runtime_error("no driver v4l2 in this build");
}

/// Before a file of an unplugged device is closed: uvcvideo of Linux 6.1 may read through a null
/// pointer where the kernel is still about to take the device down at that time.
void wait_until_gone(const std::string& folder) {
  EXPECT_TRUE(eventually([&] { return !std::filesystem::exists(folder); })) << folder;
}

class Uvc : public testing::Test {
 protected:
  Hardware open(std::map<std::string, std::string> keys = {}, const OpenOptions& options = {}) {
    keys.emplace("device", device_);
    return open_v4l2(std::move(keys), options);
  }

  void TearDown() override {
    EXPECT_TRUE(eventually([] { return camera_status("focus_auto") == 1; }));
    EXPECT_EQ(camera_status("exposure_auto"), 1);
    EXPECT_EQ(camera_status("white_balance_auto"), 1);
  }

  /// No frames from now on, and none left in the driver.
  static void stall(Camera& camera) {
    usb("camera stall");
    while (camera.grab(300ms)) {
    }
  }

  /// An unplugged camera cannot be put back as it was found, and this one remembers.
  void switch_on_automatics() {
    ASSERT_TRUE(eventually([&] { return can_be_opened(device_); }));
    set_control(device_, "Auto Exposure", V4L2_EXPOSURE_APERTURE_PRIORITY);
    set_control(device_, "Focus, Automatic Continuous", 1);
    set_control(device_, "White Balance, Automatic", 1);
  }

  const std::string device_ = device_file("FATHOM_VIDEO");
};

TEST_F(Uvc, IsFound) {
  const auto all = v4l2().find();
  const auto found = std::find_if(all.begin(), all.end(), [&](const FoundHardware& one) {
    return one.description.find("(" + device_ + ")") != std::string::npos;
  });
  ASSERT_NE(found, all.end());
  EXPECT_TRUE(found->has_camera && found->has_lens);
  EXPECT_EQ(found->problem, "");
  for (const char* text :
       {"Simulated focus camera", "Y16, Y12", "MJPEG 256 x 240", "focus 0 to 1000"}) {
    EXPECT_NE(found->description.find(text), std::string::npos) << found->description;
  }
  const Hardware rig = open_hardware(found->text);
  EXPECT_TRUE(rig.camera->grab(5s));
  for (const FoundHardware& one : v4l2().find()) {
    EXPECT_EQ(one.problem, one.text == found->text ? "in use by another program" : "");
  }
}

TEST_F(Uvc, AutomaticsAreOffWhileOpen) {
  const Hardware rig = open({{"exposure_ms", "20"}, {"gain", "32"}});
  EXPECT_EQ(camera_status("focus_auto"), 0);
  EXPECT_EQ(camera_status("exposure_auto"), 0);
  EXPECT_EQ(camera_status("white_balance_auto"), 0);
  EXPECT_EQ(camera_status("exposure_ms"), 20);
  EXPECT_EQ(camera_status("gain"), 32);
}

TEST_F(Uvc, WhatWasSetIsPutBack) {
  set_control(device_, "Gain", 77);
  { const Hardware rig = open({{"exposure_ms", "20"}, {"gain", "32"}}); }
  EXPECT_EQ(camera_status("gain"), 77);
  set_control(device_, "Gain", 16);
}

/// A refusal and the driver's questions why; TearDown() looks.
TEST_F(Uvc, WhatIsRefusedWhileClosingIsPutBackAllTheSame) {
  const Hardware rig = open();
  usb("camera refuse 3");
}

TEST_F(Uvc, ALensAloneSwitchesOffItsOwnAutomatic) {
  const Hardware rig = open({}, {.camera = false, .lens = true});
  EXPECT_EQ(camera_status("focus_auto"), 0);
  EXPECT_EQ(camera_status("exposure_auto"), 1);
  EXPECT_EQ(rig.lens->move_to(321).position, 321);
  EXPECT_EQ(camera_status("lens"), 321);
}

TEST_F(Uvc, EveryFormatShowsTheSamePicture) {
  std::map<std::string, std::vector<std::uint32_t>> pictures;
  for (const char* format : {"GREY", "YUYV", "NV12", "MJPEG", "Y10", "Y12", "Y16"}) {
    const Hardware rig = open({{"format", format}, {"exposure_ms", "10"}});
    const Frame frame = frame_after(*rig.camera, rig.lens->move_to(640).settled_ns);
    ASSERT_EQ(frame.width_px(), 256) << format;
    ASSERT_EQ(frame.height_px(), 240) << format;
    const bool is_deep = std::string_view(format).starts_with("Y1");
    EXPECT_EQ(frame.depth(), is_deep ? Depth::bits16 : Depth::bits8) << format;
    auto& pixels = pictures[format];
    for (int y = 0; y < 240; ++y) {
      for (int x = 0; x < 256; ++x) pixels.push_back(frame.at(x, y));
    }
  }
  const auto& grey = pictures["GREY"];
  EXPECT_GT(*std::max_element(grey.begin(), grey.end()),
            *std::min_element(grey.begin(), grey.end()) + 50);
  for (const auto& [format, shift] :
       {std::pair{"YUYV", 0}, {"NV12", 0}, {"Y10", 2}, {"Y12", 4}, {"Y16", 8}}) {
    const auto& pixels = pictures[format];
    for (std::size_t i = 0; i < grey.size(); ++i) ASSERT_EQ(pixels[i] >> shift, grey[i]) << format;
  }
  double off = 0;
  for (std::size_t i = 0; i < grey.size(); ++i) {
    off += std::abs(static_cast<double>(pictures["MJPEG"][i]) - grey[i]);
  }
  EXPECT_LT(off / static_cast<double>(grey.size()), 4) << "quality 92 changes that much at most";
}

TEST_F(Uvc, SizesAreCheckedWithoutDisturbingTheStream) {
  const Hardware rig = open();
  ASSERT_TRUE(rig.camera->grab(5s));
  CameraSettings wished = rig.camera->settings();
  wished.width_px = 5000;
  EXPECT_EQ(rig.camera->validate(wished), Validity::adjusted);
  EXPECT_TRUE(rig.camera->grab(5s));
  wished.width_px = 640, wished.height_px = 480;
  rig.camera->apply(wished);
  EXPECT_EQ(rig.camera->grab(5s)->width_px(), 640);
  expect_error(ErrorCode::unsupported, [&] { open({{"width", "333"}}); }, {"nearest"});
}

TEST_F(Uvc, FramesOfASettledLensAreSharpAsThatPlace) {
  const Hardware rig = open({{"format", "GREY"}});
  const auto sum_at = [&](double position) {
    const Frame frame = frame_after(*rig.camera, rig.lens->move_to(position).settled_ns);
    std::uint64_t sum = 0;
    for (int y = 0; y < frame.height_px(); ++y) {
      for (int x = 1; x < frame.width_px(); ++x) {
        const int step = static_cast<int>(frame.at(x, y)) - static_cast<int>(frame.at(x - 1, y));
        sum += static_cast<std::uint64_t>(step * step);
      }
    }
    return sum;
  };
  const std::uint64_t near = sum_at(600), best = sum_at(640), far = sum_at(100);
  EXPECT_GT(best, near);
  EXPECT_GT(near, far);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(sum_at(100), far) << i;
    EXPECT_EQ(sum_at(640), best) << i;
  }
}

TEST_F(Uvc, ALongPauseGivesNoOldFrameForNew) {
  const Hardware rig = open();
  ASSERT_TRUE(rig.camera->grab(5s));
  sleep_until_ns(monotonic_now_ns() + 1'500'000'000);
  const std::int64_t now_ns = monotonic_now_ns();
  const auto first = rig.camera->grab(5s);
  ASSERT_TRUE(first);
  EXPECT_LT(first->exposure.start_ns, now_ns - 1'000'000'000) << "it is as old as the pause";
  EXPECT_LT(time_of([&] { frame_after(*rig.camera, now_ns); }), 1s);
  EXPECT_EQ(rig.camera->counts().dropped, 0U) << "nobody read: that is no loss";
}

TEST_F(Uvc, AStallIsNothingAtTheTimeout) {
  const Hardware rig = open();
  ASSERT_TRUE(rig.camera->grab(5s));
  stall(*rig.camera);
  const auto waited = time_of([&] { EXPECT_FALSE(rig.camera->grab(700ms)); });
  EXPECT_GE(waited, 700ms);
  EXPECT_LT(waited, 1500ms);
  usb("camera resume");
  EXPECT_TRUE(rig.camera->grab(5s));
}

TEST_F(Uvc, DamagedFramesAreCountedAndNotGivenOut) {
  const Hardware rig = open({{"format", "MJPEG"}});
  ASSERT_TRUE(rig.camera->grab(5s));
  const FrameCounts before = rig.camera->counts();
  usb("camera shorten 3");  // uvcvideo lets half a JPEG pass
  for (int i = 0; i < 8; ++i) ASSERT_TRUE(rig.camera->grab(5s));
  EXPECT_EQ(rig.camera->counts().corrupt - before.corrupt, 3U);
  EXPECT_EQ(rig.camera->counts().delivered - before.delivered, 8U);
}

/// uvcvideo throws away what the camera marks as wrong, and leaves a gap in its numbers.
TEST_F(Uvc, FramesThatTheDriverThrowsAwayAreCounted) {
  const Hardware rig = open({{"format", "GREY"}});
  ASSERT_TRUE(rig.camera->grab(5s));
  const FrameCounts before = rig.camera->counts();
  usb("camera corrupt 3");
  for (int i = 0; i < 8; ++i) ASSERT_TRUE(rig.camera->grab(5s));
  const FrameCounts after = rig.camera->counts();
  EXPECT_EQ(after.dropped - before.dropped + after.corrupt - before.corrupt, 3U);
}

TEST_F(Uvc, AStreamingCameraIsInUseForOthers) {
  const Hardware rig = open();
  // A program of its own: within one, camera and lens share the file that is open.
  const pid_t other = ::fork();
  ASSERT_NE(other, -1);
  if (other == 0) {
    ::execl("/proc/self/exe", "uvc_test", kOpenOnly, nullptr);
    ::_exit(127);
  }
  int status = -1;
  ::waitpid(other, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), kInUse);
  EXPECT_TRUE(rig.camera->grab(5s));
  EXPECT_EQ(camera_status("exposure_auto"), 0) << "the other one has touched nothing";
}

TEST_F(Uvc, ARefusedMoveIsAnError) {
  const Hardware rig = open();
  rig.lens->move_to(500);
  usb("camera refuse 1");
  expect_error(ErrorCode::io, [&] { rig.lens->move_to(700); }, {"700"});
  EXPECT_EQ(rig.lens->move_to(700).position, 700);
  EXPECT_EQ(camera_status("lens"), 700);
}

TEST_F(Uvc, AMoveThatIsNeverAnsweredEnds) {
  const Hardware rig = open();
  usb("camera ignore 1");
  const auto waited = time_of([&] {
    try {
      rig.lens->move_to(700);
      ADD_FAILURE() << "arrived";
    } catch (const Error& error) {
      EXPECT_TRUE(error.code() == ErrorCode::timeout || error.code() == ErrorCode::io)
          << error.what();
    }
  });
  EXPECT_LT(waited, 12s);
  EXPECT_EQ(rig.lens->move_to(700).position, 700);
}

TEST_F(Uvc, AClampInSilenceIsCaught) {
  const Hardware rig = open();
  usb("camera clamp 0 500");
  expect_error(ErrorCode::device_lost, [&] { rig.lens->move_to(700); }, {"700", "500"});
  usb("camera clamp 0 1000");
  EXPECT_EQ(rig.lens->move_to(700).position, 700);
}

TEST_F(Uvc, UnpluggingIsAnErrorAndItCanBeOpenedAgain) {
  for (const bool is_waiting : {true, false}) {
    {
      const Hardware rig = open();
      ASSERT_TRUE(rig.camera->grab(5s));
      if (is_waiting) stall(*rig.camera);
      const std::string folder = device_folder(device_);
      usb("camera unplug");
      const auto grab_all = [&] {
        while (rig.camera->grab(5s)) {
        }
      };
      EXPECT_LT(time_of([&] { expect_error(ErrorCode::device_lost, grab_all, {"unplugged"}); }),
                3s);
      expect_error(ErrorCode::device_lost, grab_all);
      expect_error(ErrorCode::device_lost, [&] { rig.lens->move_to(100); });
      wait_until_gone(folder);
    }
    usb("camera resume");
    usb("camera plug");
    switch_on_automatics();
    EXPECT_TRUE(open().camera->grab(5s));
  }
}

TEST_F(Uvc, UnpluggingEndsAMove) {
  {
    const Hardware rig = open({{"speed", "100"}}, {.camera = false, .lens = true});
    const std::string folder = device_folder(device_);
    std::thread puller([] {
      std::this_thread::sleep_for(500ms);
      usb("camera unplug");
    });
    const double away = rig.lens->position() < 500 ? 600 : 400;
    expect_error(ErrorCode::device_lost, [&] { rig.lens->move_to(away); });
    puller.join();
    wait_until_gone(folder);
  }
  usb("camera plug");
  switch_on_automatics();
}

}  // namespace
}  // namespace fathom::test

int main(int argc, char** argv) {
  using namespace fathom::test;
  if (argc == 2 && std::string_view(argv[1]) == kOpenOnly) return open_only();
  return run_on_device(argc, argv, "FATHOM_VIDEO", "simulated USB camera");
}
