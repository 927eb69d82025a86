// SPDX-License-Identifier: Apache-2.0
// What goes wrong between an INDI server and us: each is an Error in time, and the rig can be
// opened again.
#include <thread>

#include "support.hpp"

namespace fathom::test {
namespace {

struct Trouble {
  Fault fault;
  ErrorCode code;
  const char* text;
};

void PrintTo(const Trouble& trouble, std::ostream* out) {
  *out << "fault " << static_cast<int>(trouble.fault);
}

class IndiTrouble : public testing::TestWithParam<Trouble> {};

class IndiCameraTrouble : public IndiTrouble {};

TEST_P(IndiCameraTrouble, IsAnErrorInTimeAndTheCameraCanBeOpenedAgain) {
  FakeServer server;
  server.set_picture(ramp_picture());
  // What is heard must not come too late on a busy machine; only silence is waited for in vain.
  const bool is_heard = GetParam().code == ErrorCode::bad_data;
  {
    const Hardware rig =
        open_camera(server, is_heard ? "exposure_ms=20,timeout_s=2.5" : "exposure_ms=20");
    ASSERT_TRUE(rig.camera->grab(2s));
    server.misbehave(GetParam().fault);
    expect_within(4s, [&] {
      expect_error(GetParam().code, [&] { rig.camera->grab(3s); }, {GetParam().text});
    });
    EXPECT_EQ(rig.camera->counts().delivered, 1u);
    server.misbehave(Fault::none);  // a camera that is lost stays lost all the same
    expect_error(ErrorCode::device_lost, [&] { rig.camera->grab(1s); }, {"open it again"});
  }
  server.misbehave(Fault::none);
  if (GetParam().fault == Fault::driver_dies) return;  // it does not come back by itself
  const Hardware again = open_camera(server);
  EXPECT_TRUE(again.camera->grab(2s));
}

INSTANTIATE_TEST_SUITE_P(
    Troubles, IndiCameraTrouble,
    testing::Values(Trouble{Fault::no_answer, ErrorCode::device_lost, "no picture"},
                    Trouble{Fault::no_picture, ErrorCode::device_lost, "no picture"},
                    Trouble{Fault::close_in_exposure, ErrorCode::device_lost, "closed"},
                    Trouble{Fault::close_in_picture, ErrorCode::device_lost, "closed"},
                    Trouble{Fault::driver_dies, ErrorCode::device_lost, "crashed"},
                    Trouble{Fault::alert, ErrorCode::device_lost, "it smokes"},
                    Trouble{Fault::short_picture, ErrorCode::bad_data, "truncated"},
                    Trouble{Fault::no_base64, ErrorCode::bad_data, "truncated"},
                    Trouble{Fault::announces_gigabytes, ErrorCode::bad_data, "5000000000"},
                    Trouble{Fault::endless_picture, ErrorCode::bad_data, "are expected"},
                    Trouble{Fault::bad_xml, ErrorCode::bad_data, "XML"}));

TEST(IndiCameraTrouble, DamagedPicturesAreCountedAndOnlyAFewAreForgiven) {
  FakeServer server;
  server.set_picture(ramp_picture());
  const Hardware rig = open_camera(server);
  server.misbehave(Fault::short_picture);
  expect_error(ErrorCode::bad_data, [&] { rig.camera->grab(2s); }, {"truncated"});
  EXPECT_EQ(rig.camera->counts(), (FrameCounts{0, 0, 3}));
}

TEST(IndiCameraTrouble, OneDamagedPictureIsForgiven) {
  FakeServer server;
  server.set_picture(ramp_picture());
  const Hardware rig = open_camera(server, "exposure_ms=150");
  server.misbehave(Fault::short_picture);
  std::thread healer([&] {
    std::this_thread::sleep_for(220ms);  // in the second exposure
    server.misbehave(Fault::none);
  });
  EXPECT_TRUE(rig.camera->grab(2s));
  healer.join();
  EXPECT_EQ(rig.camera->counts(), (FrameCounts{1, 0, 1}));
}

TEST(IndiCameraTrouble, APictureOfAnotherSizeIsNotGivenOut) {
  FakeServer server;
  server.set_picture(ramp_picture(48, 64));
  const Hardware rig = open_camera(server);
  expect_error(ErrorCode::bad_data, [&] { rig.camera->grab(2s); }, {"48 x 64", "64 x 48"});
}

TEST(IndiCameraTrouble, AFloodDoesNotHoldItUp) {
  FakeServer server;
  server.set_picture(ramp_picture());
  const Hardware rig = open_camera(server);
  server.misbehave(Fault::flood);
  expect_within(2s, [&] { rig.camera->grab(200ms); });
}

class IndiLensTrouble : public IndiTrouble {};

TEST_P(IndiLensTrouble, IsAnErrorInTimeAndTheMotorStands) {
  FakeServer server;
  {
    const Hardware rig = open_lens(server);
    ASSERT_EQ(rig.lens->move_to(100).position, 100);
    server.misbehave(GetParam().fault);
    expect_within(4s, [&] {
      expect_error(GetParam().code, [&] { rig.lens->move_to(900); }, {GetParam().text});
    });
  }
  server.misbehave(Fault::none);
  if (GetParam().fault == Fault::driver_dies) return;
  if (GetParam().fault == Fault::nowhere)  // somebody has looked at it
    server.set("Foc", "ABS_FOCUS_POSITION", "FOCUS_ABSOLUTE_POSITION", "500");
  EXPECT_EQ(open_lens(server).lens->move_to(300).position, 300);
}

INSTANTIATE_TEST_SUITE_P(
    Troubles, IndiLensTrouble,
    testing::Values(Trouble{Fault::no_answer, ErrorCode::device_lost, "no progress"},
                    Trouble{Fault::blocked, ErrorCode::device_lost, "no progress"},
                    Trouble{Fault::stops_short, ErrorCode::device_lost, "stopped at 100"},
                    Trouble{Fault::nowhere, ErrorCode::bad_data, "stands at nan"},
                    Trouble{Fault::swings, ErrorCode::device_lost, "no progress"},
                    Trouble{Fault::driver_dies, ErrorCode::device_lost, "crashed"},
                    Trouble{Fault::alert, ErrorCode::device_lost, "it smokes"},
                    Trouble{Fault::bad_xml, ErrorCode::bad_data, "XML"}));

TEST(IndiLensTrouble, AStopIsHeardHoweverMuchIsSaid) {
  for (const Fault fault : {Fault::swings, Fault::blocked}) {
    FakeServer server;
    std::atomic<int> requests = 0;
    const Hardware rig =
        open_hardware("indi:server=" + server.address() + ",stall_s=60",
                      {.camera = false, .stop_requests = [&] { return requests.load(); }});
    server.misbehave(fault);
    std::thread user([&] {
      while (!server.is_moving()) std::this_thread::sleep_for(1ms);
      requests = 1;
    });
    expect_within(4s, [&] { expect_error(ErrorCode::cancelled, [&] { rig.lens->move_to(900); }); });
    user.join();
    EXPECT_EQ(server.requests("FOCUS_ABORT_MOTION"), 1);
  }
}

TEST(IndiOpening, AStopIsHeardWhileNobodyAnswers) {
  FakeServer server;
  server.misbehave(Fault::no_answer);
  const auto began = std::chrono::steady_clock::now();
  const auto requests = [&] {  // asked for the first time when the waiting begins
    return std::chrono::steady_clock::now() - began > 200ms ? 1 : 0;
  };
  expect_within(2s, [&] {
    expect_error(ErrorCode::cancelled, [&] {
      open_hardware("indi:server=" + server.address() + ",timeout_s=60",
                    {.lens = false, .stop_requests = requests});
    });
  });
}

TEST(IndiOpening, NobodyListensIsSaidAtOnce) {
  std::string address;
  {
    const FakeServer server;
    address = server.address();
  }
  expect_within(1s, [&] {
    expect_error(ErrorCode::unavailable, [&] { open_hardware("indi:" + address); },
                 {address.c_str(), "indiserver"});
  });
}

TEST(IndiOpening, AServerThatSaysNothingIsATimeout) {
  FakeServer server;
  server.misbehave(Fault::no_answer);
  expect_within(3s, [&] {
    expect_error(ErrorCode::timeout, [&] { open_camera(server, "camera=Cam"); }, {"CONNECTION"});
  });
}

TEST(IndiOpening, APropertyThatNeverAppearsIsATimeout) {
  FakeServer server;
  server.remove("Cam", "CCD_FRAME");
  expect_within(4s, [&] {
    expect_error(ErrorCode::timeout, [&] { open_camera(server); }, {"Cam", "CCD_FRAME"});
  });
}

TEST(IndiOpening, ADeviceThatDoesNotConnectSaysWhy) {
  FakeServer server;
  server.misbehave(Fault::alert);
  expect_error(ErrorCode::unavailable, [&] { open_camera(server); }, {"it smokes"});
}

TEST(IndiOpening, AChipThatNobodyBuildsIsRefused) {
  FakeServer server;
  server.set("Cam", "CCD_INFO", "CCD_MAX_X", "1e300");
  expect_error(ErrorCode::bad_data, [&] { open_camera(server); }, {"CCD_MAX_X"});
  server.set("Cam", "CCD_INFO", "CCD_MAX_X", "many");
  expect_error(ErrorCode::bad_data, [&] { open_camera(server); }, {"CCD_MAX_X"});
}

TEST(IndiOpening, AddressesThatAreNoneAreRefused) {
  for (const char* address : {"indi::7624", "indi:host:", "indi:host:port", "indi:host:70000",
                              "indi:[::1", "indi:host:1:2"}) {
    expect_error(ErrorCode::bad_argument, [&] { open_hardware(address); }, {"HOST:PORT"});
  }
}

}  // namespace
}  // namespace fathom::test
