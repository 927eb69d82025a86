// SPDX-License-Identifier: Apache-2.0
// A camera and a focuser behind HTTP, as they should be and as they should not.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "fake_server.hpp"
#include "hal/clock.hpp"
#include "hal/drivers/alpaca/discovery.hpp"
#include "hal/drivers/alpaca/image.hpp"
#include "hal/drivers/alpaca/settings.hpp"
#include "hal/rig_text.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

Hardware camera_of(const FakeAlpaca& server, const std::string& keys = ",exposure_ms=5",
                   const StopRequests& stop = never_stop) {
  return open_hardware(server.rig(keys), {.camera = true, .lens = false, .stop_requests = stop});
}

Hardware lens_of(const FakeAlpaca& server, const std::string& keys = "",
                 const StopRequests& stop = never_stop) {
  return open_hardware(server.rig(",settle_ms=1" + keys),
                       {.camera = false, .lens = true, .stop_requests = stop});
}

TEST(AlpacaCamera, GivesItsPicturesAsBytesAndAsJson) {
  for (const bool as_bytes : {true, false}) {
    for (const bool in_colour : {false, true}) {
      for (const int brightest : {255, 65535}) {
        const FakeAlpaca server(
            {.brightest = brightest, .gives_bytes = as_bytes, .is_colour = in_colour});
        const Hardware rig = camera_of(server);
        const std::int64_t asked_ns = monotonic_now_ns();
        const auto frame = rig.camera->grab(10s);
        ASSERT_TRUE(frame);
        ASSERT_EQ(frame->width_px(), 60);
        ASSERT_EQ(frame->height_px(), 40);
        EXPECT_EQ(frame->depth(), brightest > 255 ? Depth::bits16 : Depth::bits8);
        for (int y = 0; y < 40; y += 3)
          for (int x = 0; x < 60; x += 7)
            EXPECT_EQ(frame->at(x, y), static_cast<unsigned>(std::min(10 * x + y, brightest)));
        EXPECT_GE(frame->exposure.start_ns, asked_ns);
        EXPECT_GE(frame->exposure.end_ns, frame->exposure.start_ns + 5'000'000);
        EXPECT_EQ(rig.camera->counts(), (FrameCounts{1, 0, 0}));
      }
    }
  }
}

TEST(AlpacaCamera, TakesARegionAndPutsEverythingBack) {
  FakeAlpaca server;
  {
    const Hardware rig = camera_of(server, ",exposure_ms=2,x=8,width=20,binning=2,gain=9");
    EXPECT_EQ(server.value("binx"), 2);
    EXPECT_EQ(server.value("startx"), 8);
    EXPECT_EQ(server.value("numx"), 20);
    EXPECT_EQ(server.value("numy"), 20) << "all that binning leaves";
    EXPECT_EQ(server.value("gain"), 9);
    EXPECT_EQ(rig.camera->grab(10s)->at(0, 0), 80u);
  }
  EXPECT_EQ(server.value("binx"), 1);
  EXPECT_EQ(server.value("startx"), 0);
  EXPECT_EQ(server.value("numx"), 60);
  EXPECT_EQ(server.value("gain"), 5);
  EXPECT_EQ(server.value("connected"), 0);
}

TEST(AlpacaCamera, RefusesWhatItCannotKeep) {
  const FakeAlpaca server;
  const auto refused = [&](const std::string& keys, std::initializer_list<const char*> words,
                           ErrorCode code = ErrorCode::unsupported) {
    expect_error(
        code, [&] { camera_of(server, keys); }, words);
  };
  refused(",binning=9", {"binning=9", "4"});
  refused(",x=50,width=30", {"60 px"});
  refused(",exposure_ms=30000", {"exposure_ms=30000", "20000"});
  refused(",camera=Moon", {"camera \"Moon\""}, ErrorCode::unavailable);
  refused(",speed=3", {"speed"}, ErrorCode::bad_argument);
}

TEST(AlpacaFaults, ADamagedPictureIsCountedAndNeverGivenOut) {
  for (const bool as_bytes : {true, false}) {
    FakeAlpaca server({.gives_bytes = as_bytes});
    const Hardware rig = camera_of(server);
    server.set_faults({.cut_bytes = 1});
    expect_error(ErrorCode::device_lost, [&] { rig.camera->grab(10s); }, {"picture"});
    EXPECT_EQ(rig.camera->counts().delivered, 0u);
    EXPECT_EQ(rig.camera->counts().corrupt, 3u);
    expect_error(ErrorCode::device_lost, [&] { rig.camera->grab(10s); });
    server.set_faults({});
    EXPECT_TRUE(camera_of(server).camera->grab(10s));
  }
}

TEST(AlpacaFaults, EachEndsWithAReasonAndInTime) {
  struct Case {
    AlpacaFaults faults;
    const char* word;
  };
  const Case cases[] = {
      {{.failing = "imageready"}, "it does not want to"},
      {{.failing = "startexposure", .error_number = 0x407}, "it does not want to"},
      {{.failing = "imagearray"}, "imagearray"},
      {{.garbled = "imageready"}, "no JSON"},
      {{.garbled = "startexposure"}, "no JSON"},
      {{.is_another = true}, "another question"},
      {{.delay_ms = 900}, "no answer within"},
      {{.status = 500}, "HTTP status 500"},
      {{.never_ready = true}, "no picture"},
  };
  for (const Case& fault : cases) {
    FakeAlpaca server;
    const Hardware rig = camera_of(server, ",exposure_ms=5,timeout_s=0.4");
    server.set_faults(fault.faults);
    const std::int64_t asked_ns = monotonic_now_ns();
    expect_error(ErrorCode::device_lost, [&] { rig.camera->grab(20s); }, {fault.word});
    EXPECT_LT(monotonic_now_ns() - asked_ns, 10'000'000'000) << fault.word;
    server.set_faults({});
  }
}

TEST(AlpacaFaults, AServerThatDiesIsLostAndOneThatIsNotThereIsSaidSo) {
  FakeAlpaca server;
  const Hardware rig = open_hardware(server.rig(",exposure_ms=5,settle_ms=1,timeout_s=1"));
  ASSERT_TRUE(rig.camera->grab(10s));
  server.die();
  expect_error(ErrorCode::device_lost, [&] { rig.camera->grab(5s); }, {"Alpaca"});
  expect_error(ErrorCode::device_lost, [&] { rig.lens->move_to(100); }, {"Alpaca"});
  expect_error(ErrorCode::unavailable, [&] { open_hardware(server.rig()); }, {"does it run"});
  expect_error(ErrorCode::bad_argument, [] { open_hardware("alpaca:host:99999"); }, {"HOST:PORT"});
}

TEST(AlpacaFaults, AWishToStopEndsAnExposureAndAMove) {
  int requests = 0;
  FakeAlpaca server({.steps_per_s = 100});
  const auto stop_soon = [&]() { return server.requests() > requests + 4 ? 1 : 0; };
  const Hardware rig =
      open_hardware(server.rig(",exposure_ms=15000,settle_ms=1"), {.stop_requests = stop_soon});
  requests = server.requests();
  const std::int64_t asked_ns = monotonic_now_ns();
  expect_error(ErrorCode::cancelled, [&] { rig.camera->grab(30s); });
  requests = server.requests();
  expect_error(ErrorCode::cancelled, [&] { rig.lens->move_to(1000); });
  EXPECT_FALSE(server.is_moving());
  EXPECT_LT(server.step(), 300);
  EXPECT_LT(monotonic_now_ns() - asked_ns, 10'000'000'000);
}

TEST(AlpacaFocuser, GoesWhereItIsSentInMovesThatItsDriverTakes) {
  FakeAlpaca server;
  {
    const Hardware rig = lens_of(server, ",backlash=20");
    EXPECT_EQ(server.value("tempcomp"), 0) << "what moves it by itself is off";
    EXPECT_EQ(rig.lens->info().highest, 1000);
    EXPECT_EQ(rig.lens->move_to(950).position, 950);
    EXPECT_EQ(rig.lens->move_to(400.2).position, 400);
    EXPECT_EQ(server.step(), 400);
    EXPECT_EQ(rig.lens->home().position, 0);
    expect_error(ErrorCode::out_of_bounds, [&] { rig.lens->move_to(1001); });
  }
  EXPECT_EQ(server.value("tempcomp"), 1);
  EXPECT_EQ(server.value("connected"), 0);
}

TEST(AlpacaFocuser, ARelativeOneCountsFromWhereItIsSaidToStand) {
  FakeAlpaca server({.is_absolute = false});
  expect_error(ErrorCode::bad_argument, [&] { lens_of(server); }, {"travel=STEPS"});
  const Hardware rig = lens_of(server, ",travel=800");
  expect_error(ErrorCode::unavailable, [&] { rig.lens->move_to(100); }, {"start=STEPS"});
  EXPECT_EQ(rig.lens->home().position, 0);
  EXPECT_EQ(rig.lens->move_to(700).position, 700);
  EXPECT_EQ(server.step(), 700);
  const Hardware told = lens_of(server, ",travel=800,start=700");
  EXPECT_EQ(told.lens->move_to(100).position, 100);
  EXPECT_EQ(server.step(), 100);
}

TEST(AlpacaFocuser, OneThatComesNowhereIsStoppedAndSaidSo) {
  FakeAlpaca server;
  const Hardware rig = lens_of(server, ",stall_s=0.3");
  server.set_faults({.is_stuck = true});
  const std::int64_t asked_ns = monotonic_now_ns();
  expect_error(ErrorCode::device_lost, [&] { rig.lens->move_to(200); }, {"blocked"});
  EXPECT_LT(monotonic_now_ns() - asked_ns, 5'000'000'000);
}

TEST(AlpacaParts, TheExampleIsRead) {
  const RigRequest request = parse_rig(FATHOM_EXAMPLE_RIGS "/alpaca.toml");
  EXPECT_STREQ(request.camera.driver->name(), "alpaca");
  EXPECT_NO_THROW(alpaca::Settings::read(request.camera.settings));
  EXPECT_NO_THROW(request.camera.settings.require_all_used());
}

TEST(AlpacaParts, ADiscoveryAnswerNamesAPortOrIsNone) {
  EXPECT_EQ(alpaca::port_in(R"({"AlpacaPort":11111})"), 11111);
  for (const char* const text : {"", "{}", "[1]", R"({"AlpacaPort":0})", R"({"AlpacaPort":70000})",
                                 R"({"AlpacaPort":"80"})", "alpacadiscovery1"})
    EXPECT_EQ(alpaca::port_in(text), 0) << text;
}

TEST(AlpacaParts, EveryElementTypeOfImageBytesIsRead) {
  // 1 x 2 pixels of 7 and 200, as each type has them.
  const std::pair<int, std::vector<std::uint8_t>> types[] = {
      {1, {7, 0, 200, 0}},
      {2, {7, 0, 0, 0, 200, 0, 0, 0}},
      {3, {0, 0, 0, 0, 0, 0, 0x1c, 0x40, 0, 0, 0, 0, 0, 0, 0x69, 0x40}},
      {4, {0, 0, 0xe0, 0x40, 0, 0, 0x48, 0x43}},
      {5, {7, 0, 0, 0, 0, 0, 0, 0, 200, 0, 0, 0, 0, 0, 0, 0}},
      {6, {7, 200}},
      {7, {7, 0, 0, 0, 0, 0, 0, 0, 200, 0, 0, 0, 0, 0, 0, 0}},
      {8, {7, 0, 200, 0}},
      {9, {7, 0, 0, 0, 200, 0, 0, 0}}};
  for (const auto& [type, data] : types) {
    std::vector<std::uint8_t> bytes;
    for (const int word : {1, 0, 0, 0, 44, 2, type, 2, 1, 2, 0})
      bytes.insert(bytes.end(), {static_cast<std::uint8_t>(word), 0, 0, 0});
    bytes.insert(bytes.end(), data.begin(), data.end());
    const Frame frame = alpaca::frame_of_bytes(bytes, {1, 2, Depth::bits16});
    EXPECT_EQ(frame.at(0, 0), 7u) << type;
    EXPECT_EQ(frame.at(0, 1), 200u) << type;
    bytes.pop_back();
    expect_error(ErrorCode::bad_data, [&] {
      alpaca::frame_of_bytes(bytes, {1, 2, Depth::bits16});
    });
  }
}

}  // namespace
}  // namespace fathom::test
