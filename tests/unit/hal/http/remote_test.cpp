// SPDX-License-Identifier: Apache-2.0
// A rig that is served by another program, and every way in which that goes wrong.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>

#include "hal/rig_driver.hpp"
#include "made_up_server.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/unit/serve/served_rig.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

constexpr const char* kSim = "sim:target=seedling,distance=1800";

TEST(RemoteRig, FramesAreThoseOfTheRigToTheLastBit) {
  const std::string rig = "sim:target=seedling,noise=0,drift=0,start=600";
  const ServedRig served(rig);
  Hardware far = open_hardware(served.text()), near = open_hardware(rig);
  EXPECT_EQ(far.lens->position(), 600);
  far.lens->move_to(784);
  near.lens->move_to(784);
  const Frame there = far.camera->grab(5s).value(), here = near.camera->grab(5s).value();
  ASSERT_EQ(there.width_px(), here.width_px());
  ASSERT_EQ(there.height_px(), here.height_px());
  for (int y = 0; y < here.height_px(); ++y)
    EXPECT_EQ(std::memcmp(there.row(y), here.row(y), static_cast<std::size_t>(here.width_px())), 0);
  EXPECT_EQ(far.lens->info().coarse_spacing, near.lens->info().coarse_spacing);
  EXPECT_EQ(far.lens->info().optics, near.lens->info().optics);
  EXPECT_EQ(far.stage->distance_mm(), near.stage->distance_mm());
}

TEST(RemoteRig, AMoveThatCannotBeEndsInTheRigsOwnWords) {
  const ServedRig served(kSim);
  const Hardware rig = open_hardware(served.text());
  expect_error(ErrorCode::out_of_bounds, [&] { rig.lens->move_to(5000); });
  expect_error(ErrorCode::out_of_bounds, [&] { rig.stage->place_at(-1); });
  expect_error(ErrorCode::unsupported, [&] { rig.lens->declare_at(3); },
               {"where it is plugged in"});
}

TEST(RemoteRig, OneDrivesAndGivesItBack) {
  const ServedRig served(kSim);
  {
    const Hardware first = open_hardware(served.text());
    expect_error(ErrorCode::unavailable, [&] { open_hardware(served.text()); },
                 {"somebody else drives"});
    EXPECT_TRUE(first.camera->grab(5s));
  }
  EXPECT_NO_THROW(open_hardware(served.text()));
}

TEST(RemoteRig, IsRefusedInWordsThatHelp) {
  const ServedRig served(kSim), showing(kSim, true);
  expect_error(ErrorCode::unavailable,
               [&] { open_hardware(served.bare_text() + "?token=wrong-one"); },
               {"wants another token", "FATHOM_TOKEN"});
  expect_error(ErrorCode::unavailable, [&] { open_hardware(showing.text()); }, {"--read-only"});
  expect_error(ErrorCode::bad_argument, [&] { open_hardware("http:timeout_s=x"); });
}

TEST(RemoteRig, NobodyThere) {
  std::string text;
  { text = ServedRig(kSim).text(); }
  expect_error(ErrorCode::unavailable, [&] { open_hardware(text); },
               {"no fathom serve at 127.0.0.1", "start it there"});
}

TEST(RemoteRig, SomethingElseIsThere) {
  const MadeUpServer other(http_answer("200 OK", "<html>hello</html>"));
  expect_error(ErrorCode::bad_data, [&] { open_hardware(other.text()); }, {"no rig"});
  const MadeUpServer refusing(http_answer("404 Not Found", "<html>nothing</html>"));
  expect_error(ErrorCode::unavailable, [&] { open_hardware(refusing.text()); },
               {"is no fathom serve"});
  const MadeUpServer shell("SSH-2.0-OpenSSH_9.2\r\n\r\n");
  expect_error(ErrorCode::bad_data, [&] { open_hardware(shell.text()); });
  const MadeUpServer older(
      http_answer("404 Not Found", R"({"error":{"code":"not_found","message":"nothing here"}})"));
  expect_error(ErrorCode::unavailable, [&] { open_hardware(older.text()); }, {"same version"});
  const MadeUpServer named(
      http_answer("421 x", R"({"error":{"code":"foreign_host","message":"no"}})"));
  expect_error(ErrorCode::unavailable, [&] { open_hardware(named.text()); }, {"--name 127.0.0.1"});
}

TEST(RemoteRig, SilenceHasAnEndAndAWishToStopComesFirst) {
  const MadeUpServer silent("");
  expect_error(ErrorCode::timeout, [&] { open_hardware(silent.text() + ",timeout_s=0.2"); },
               {"does not answer"});
  std::atomic<int> asked = 0;
  OpenOptions options;
  options.stop_requests = [&] { return asked++ > 4 ? 1 : 0; };
  expect_error(ErrorCode::cancelled,
               [&] { open_hardware(silent.text() + ",timeout_s=600", options); });
}

TEST(RemoteRig, AServiceThatEndsIsALostDeviceEveryTime) {
  auto served = std::make_unique<ServedRig>(kSim);
  const Hardware rig = open_hardware(served->text());
  EXPECT_TRUE(rig.camera->grab(5s));
  served.reset();
  for (int i = 0; i < 2; ++i) {
    expect_error(ErrorCode::device_lost, [&] { rig.camera->grab(5s); }, {"fathom serve"});
    expect_error(ErrorCode::device_lost, [&] { rig.lens->move_to(100); });
  }
}

TEST(RemoteRig, EachHalfAloneIsConvertedByItsOwnBound) {
  const ServedRig served(kSim);
  OpenOptions lens_alone;
  lens_alone.camera = false;
  {
    const Hardware rig = open_hardware(served.text(), lens_alone);
    EXPECT_FALSE(rig.camera);
    const Arrival arrival = rig.lens->move_to(100);
    EXPECT_GE(arrival.settled_ns, arrival.stopped_ns);
  }
  OpenOptions camera_alone;
  camera_alone.lens = false;
  const Hardware rig = open_hardware(served.text(), camera_alone);
  EXPECT_FALSE(rig.lens);
  EXPECT_TRUE(rig.camera->grab(5s));
}

}  // namespace
}  // namespace fathom::test
