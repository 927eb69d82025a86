// SPDX-License-Identifier: Apache-2.0
// What an INDI camera does while all is well.
#include <thread>

#include "support.hpp"

namespace fathom::test {
namespace {

TEST(IndiCamera, GivesThePictureThatWasSent) {
  FakeServer server;
  server.set_picture(ramp_picture());
  const Hardware rig = open_camera(server);
  const std::int64_t asked_ns = monotonic_now_ns();
  const std::optional<Frame> frame = rig.camera->grab(2s);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->width_px(), 64);
  EXPECT_EQ(frame->height_px(), 48);
  EXPECT_EQ(frame->depth(), Depth::bits16);
  EXPECT_EQ(frame->at(0, 0), 1000u);
  EXPECT_EQ(frame->at(63, 47), 1000u + 13u * (64 * 48 - 1));
  EXPECT_GE(frame->exposure.start_ns, asked_ns);
  EXPECT_GE(frame->exposure.end_ns - frame->exposure.start_ns, 20'000'000);
  EXPECT_LE(frame->exposure.end_ns, monotonic_now_ns());
  EXPECT_EQ(rig.camera->counts(), (FrameCounts{1, 0, 0}));
  EXPECT_EQ(rig.lens, nullptr);
}

TEST(IndiCamera, LearnsItsSizeFromAFirstPicture) {
  FakeServer server;
  server.learn_size_from_picture();
  server.set_picture("what a DSLR sends", ".cr2");
  const Hardware rig = open_camera(server);
  EXPECT_EQ(server.requests("CCD_EXPOSURE"), 1);
  EXPECT_EQ(rig.camera->settings(), (CameraSettings{64, 48, Depth::bits16, 20}));
  server.set_picture(ramp_picture());
  EXPECT_TRUE(rig.camera->grab(2s));
}

TEST(IndiCamera, ASizeThatNoPictureTellsIsSaid) {
  FakeServer server;
  server.set("Cam", "CCD_INFO", "CCD_MAX_X", "0");
  expect_error(ErrorCode::unsupported, [&] { open_camera(server); }, {"how many pixels", "tell"});
  server.misbehave(Fault::no_picture);
  expect_error(ErrorCode::unsupported, [&] { open_camera(server); }, {"did not come"});
  EXPECT_FALSE(server.is_exposing());
}

TEST(IndiCamera, AnImpatientGrabsExposureIsCollectedByTheNext) {
  FakeServer server;
  server.set_picture(ramp_picture());
  const Hardware rig = open_camera(server, "exposure_ms=100");
  EXPECT_FALSE(rig.camera->grab(0ms));
  EXPECT_FALSE(rig.camera->grab(0ms));
  const std::int64_t before_ns = monotonic_now_ns();
  const std::optional<Frame> frame = rig.camera->grab(2s);
  ASSERT_TRUE(frame);
  EXPECT_LT(frame->exposure.start_ns, before_ns);
  EXPECT_EQ(server.requests("CCD_EXPOSURE"), 1);
}

TEST(IndiCamera, PutsBackWhatItFound) {
  FakeServer server;
  server.set_picture(ramp_picture(16, 12));
  server.add("Cam", "CCD_GAIN", "Number", {{"GAIN", "90"}});
  {
    const Hardware rig =
        open_camera(server, "exposure_ms=20,width=32,height=24,binning=2,gain=7,polling_ms=25");
    EXPECT_EQ(server.value("Cam", "CCD_COMPRESSION", "INDI_DISABLED"), "On");
    EXPECT_EQ(server.value("Cam", "UPLOAD_MODE", "UPLOAD_CLIENT"), "On");
    EXPECT_EQ(server.value("Cam", "CCD_FRAME", "X"), "16");  // in the middle
    EXPECT_EQ(server.value("Cam", "CCD_FRAME", "WIDTH"), "32");
    EXPECT_EQ(server.value("Cam", "CCD_GAIN", "GAIN"), "7");
    EXPECT_EQ(server.value("Cam", "POLLING_PERIOD", "PERIOD_MS"), "25");
    EXPECT_EQ(rig.camera->settings(), (CameraSettings{16, 12, Depth::bits16, 20}));
    EXPECT_TRUE(rig.camera->grab(2s));
  }
  EXPECT_EQ(server.value("Cam", "CCD_COMPRESSION", "INDI_ENABLED"), "On");
  EXPECT_EQ(server.value("Cam", "UPLOAD_MODE", "UPLOAD_LOCAL"), "On");
  EXPECT_EQ(server.value("Cam", "CCD_FRAME", "X"), "0");
  EXPECT_EQ(server.value("Cam", "CCD_FRAME", "WIDTH"), "64");
  EXPECT_EQ(server.value("Cam", "CCD_BINNING", "HOR_BIN"), "1");
  EXPECT_EQ(server.value("Cam", "CCD_GAIN", "GAIN"), "90");
  EXPECT_EQ(server.value("Cam", "POLLING_PERIOD", "PERIOD_MS"), "1000");
  EXPECT_EQ(server.value("Cam", "CONNECTION", "CONNECT"), "On");  // documented: it stays connected
}

TEST(IndiCamera, WhatIsRefusedOnceIsPutBackAllTheSame) {
  FakeServer server;
  {
    const Hardware rig = open_camera(server, "width=32,height=24,polling_ms=25");
    server.refuse("CCD_FRAME", 1);
    server.refuse("POLLING_PERIOD", 1);
  }
  EXPECT_EQ(server.value("Cam", "CCD_FRAME", "WIDTH"), "64");
  EXPECT_EQ(server.value("Cam", "POLLING_PERIOD", "PERIOD_MS"), "1000");
}

TEST(IndiCamera, WhatIsNeverTakenBackDoesNotHoldItUp) {
  FakeServer server;
  Hardware rig = open_camera(server, "width=32,height=24,polling_ms=25");
  server.refuse("CCD_FRAME", 100);
  server.ignore("UPLOAD_MODE");
  expect_within(4s, [&] { rig.camera.reset(); });
  EXPECT_EQ(server.value("Cam", "CCD_FRAME", "WIDTH"), "32");
  EXPECT_EQ(server.value("Cam", "POLLING_PERIOD", "PERIOD_MS"), "1000");
}

TEST(IndiCamera, AWishThatItCannotKeepIsAnErrorAndPutsTheOthersBack) {
  FakeServer server;
  expect_error(ErrorCode::unsupported, [&] { open_camera(server, "width=65"); }, {"64 x 48"});
  expect_error(ErrorCode::unsupported, [&] { open_camera(server, "gain=3"); }, {"no gain"});
  expect_error(ErrorCode::unsupported,
               [&] { open_camera(server, "binning=2,exposure_ms=3000,longest_exposure_ms=500"); },
               {"exposure_ms=3000", "500"});
  EXPECT_EQ(server.value("Cam", "CCD_BINNING", "HOR_BIN"), "1");
  EXPECT_EQ(server.value("Cam", "UPLOAD_MODE", "UPLOAD_LOCAL"), "On");
}

TEST(IndiCamera, SettingsAreCheckedAndApplied) {
  FakeServer server;
  const Hardware rig = open_camera(server);
  CameraSettings wished{1000, 24, Depth::bits8, 1e12};
  EXPECT_EQ(rig.camera->validate(wished), Validity::adjusted);
  EXPECT_EQ(wished, (CameraSettings{64, 24, Depth::bits16, 3.6e6}));
  wished.exposure_ms = 30;
  server.set_picture(ramp_picture(64, 24));
  rig.camera->apply(wished);
  EXPECT_EQ(rig.camera->settings(), wished);
  ASSERT_TRUE(rig.camera->grab(2s));
}

TEST(IndiCamera, AbortsARunningExposureWhenItIsClosed) {
  FakeServer server;
  open_camera(server, "exposure_ms=60000").camera->grab(0ms);
  EXPECT_EQ(server.requests("CCD_ABORT_EXPOSURE"), 1);
  EXPECT_FALSE(server.is_exposing());
}

TEST(IndiCamera, AStopRequestEndsAnExposure) {
  FakeServer server;
  std::atomic<int> requests = 0;
  const Hardware rig = open_camera(server, "exposure_ms=60000", [&] { return requests.load(); });
  std::thread user([&] {
    std::this_thread::sleep_for(100ms);
    requests = 1;
  });
  expect_within(1s, [&] { expect_error(ErrorCode::cancelled, [&] { rig.camera->grab(10s); }); });
  user.join();
  EXPECT_FALSE(server.is_exposing());
}

TEST(IndiCamera, IsNotTakenFromAProgramThatIsExposing) {
  FakeServer server;
  const Hardware other = open_camera(server, "exposure_ms=60000");
  other.camera->grab(0ms);
  while (!server.is_exposing()) std::this_thread::sleep_for(1ms);
  expect_error(ErrorCode::unavailable, [&] { open_camera(server); }, {"exposing"});
  EXPECT_TRUE(server.is_exposing());
}

TEST(IndiCamera, WaitsOutWhatAnotherProgramExposes) {
  FakeServer server;
  server.set_picture(ramp_picture());
  const Hardware rig = open_camera(server);
  const Hardware other = open_camera(server, "exposure_ms=300");
  const std::int64_t began_ns = monotonic_now_ns();
  other.camera->grab(0ms);
  while (!server.is_exposing()) std::this_thread::sleep_for(1ms);
  EXPECT_FALSE(rig.camera->grab(50ms));
  const std::optional<Frame> frame = rig.camera->grab(2s);
  ASSERT_TRUE(frame);
  EXPECT_GE(frame->exposure.start_ns - began_ns, 300'000'000);
  EXPECT_TRUE(other.camera->grab(2s));
}

TEST(IndiCamera, SaysThatAnotherProgramExposesForLong) {
  FakeServer server;
  const Hardware rig = open_camera(server);
  const Hardware other = open_camera(server, "exposure_ms=60000");
  other.camera->grab(0ms);
  while (!server.is_exposing()) std::this_thread::sleep_for(1ms);
  expect_within(2s, [&] {
    expect_error(ErrorCode::unavailable, [&] { rig.camera->grab(10s); }, {"another exposure"});
  });
  EXPECT_EQ(server.requests("CCD_EXPOSURE"), 1);
}

/// An exposure of 900 ms that cannot be aborted is given up, and one of 20 ms follows.
void expect_later_frame(FakeServer& server) {
  server.set_picture(ramp_picture());
  const Hardware rig = open_camera(server, "exposure_ms=900");
  const std::int64_t began_ns = monotonic_now_ns();
  rig.camera->grab(0ms);
  while (!server.is_exposing()) std::this_thread::sleep_for(1ms);
  CameraSettings shorter = rig.camera->settings();
  shorter.exposure_ms = 20;
  rig.camera->apply(shorter);
  const std::optional<Frame> frame = rig.camera->grab(3s);
  ASSERT_TRUE(frame);
  EXPECT_GE(frame->exposure.start_ns - began_ns, 900'000'000);
  EXPECT_EQ(server.requests("CCD_EXPOSURE"), 2);
}

TEST(IndiCamera, WithoutAnAbortItWaitsTheExposureOut) {
  FakeServer server;
  server.remove("Cam", "CCD_ABORT_EXPOSURE");
  expect_later_frame(server);
}

TEST(IndiCamera, AnAbortThatIsNotAnsweredIsWaitedOut) {
  FakeServer server;
  server.ignore("CCD_ABORT_EXPOSURE");
  expect_later_frame(server);
}

TEST(IndiCamera, SaysWhichPicturesItCannotTake) {
  FakeServer server;
  const Hardware rig = open_camera(server);
  const std::vector<double> pixels(64 * 48, 7);
  server.set_picture(make_fits(FLOAT_IMG, {64, 48}, pixels));
  expect_error(ErrorCode::unsupported, [&] { rig.camera->grab(2s); }, {"8 or 16 bit"});
  server.set_picture(make_fits(USHORT_IMG, {64, 48, 3}, std::vector<double>(64 * 48 * 3, 7)));
  expect_error(ErrorCode::unsupported, [&] { rig.camera->grab(2s); }, {"colour"});
  server.set_picture("x", ".fits.z");
  expect_error(ErrorCode::unsupported, [&] { rig.camera->grab(2s); }, {"compress"});
  server.set_picture("x", ".cr2");
  expect_error(ErrorCode::unsupported, [&] { rig.camera->grab(2s); }, {".cr2", "FITS"});
  server.set_picture(ramp_picture(64, 48, BYTE_IMG));
  EXPECT_TRUE(rig.camera->grab(2s));
}

TEST(IndiDriver, AsksWhichOfTwoCameras) {
  FakeServer server;
  server.add("Cam 2", "DRIVER_INFO", "Text", {{"DRIVER_INTERFACE", "2"}});
  expect_error(ErrorCode::bad_argument, [&] { open_camera(server); }, {"Cam", "Cam 2", "camera="});
  EXPECT_NE(open_camera(server, "camera=Cam").camera, nullptr);
}

TEST(IndiDriver, AnInterfaceThatIsNoNumberIsNone) {
  FakeServer server;
  server.add("Odd", "DRIVER_INFO", "Text", {{"DRIVER_INTERFACE", "99999999999999999999"}});
  server.add("Odder", "DRIVER_INFO", "Text", {{"DRIVER_INTERFACE", "2 cameras"}});
  EXPECT_NE(open_camera(server).camera, nullptr);
}

}  // namespace
}  // namespace fathom::test
