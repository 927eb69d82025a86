// SPDX-License-Identifier: Apache-2.0
#include "fixtures.hpp"

#include <algorithm>
#include <cstdlib>
#include <ostream>

#include "alpaca_rig.hpp"
#include "board_rig.hpp"
#include "engine/file.hpp"
#include "gige_rig.hpp"
#include "hal/drivers/replay/manifest.hpp"
#include "pictures/picture.hpp"
#include "serial_rig.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/serve/served_rig.hpp"

namespace fathom::test {

using namespace std::chrono_literals;

namespace {

/// A recording of 20 frames that all differ, at uneven positions.
std::string recorded_folder() {
  static const TemporaryFolder folder;
  Manifest manifest;
  manifest.unit = "steps";
  for (int i = 0; i < 20; ++i) {
    std::vector<std::uint16_t> pixels;
    for (int k = 0; k < 24 * 16; ++k) pixels.push_back(static_cast<std::uint16_t>(1000 * i + k));
    manifest.entries.push_back({std::to_string(i) + ".png", 10.0 * i + 0.1 * i * i});
    write_picture(folder / manifest.entries.back().file, Frame(24, 16, std::move(pixels)));
  }
  write_file(folder / std::string(kManifestName), manifest_text(manifest));
  return folder.path().string();
}

constexpr const char* kQuietSim = "sim:target=seedling,noise=0,drift=0,backlash=9,start=600";

/// Another program's rig: everything goes over a socket.
Hardware open_served_sim(const OpenOptions& options) {
  static const ServedRig served(kQuietSim);
  return open_hardware(served.text(), options);
}

Hardware open_served_recording(const OpenOptions& options) {
  static const ServedRig served("replay:" + recorded_folder());
  return open_hardware(served.text(), options);
}

}  // namespace

std::vector<RigFixture> rig_fixtures() {
  static const std::vector<RigFixture> fixtures = {
      {"sim", "sim", "sim", false},
      {"sim_quiet", "sim", kQuietSim, true},
      {"stepper_board", "stepper", "a made-up driver board", true, {}, open_board_rig},
      {"stepper", "stepper", "FATHOM_TEST_RIG_STEPPER", false,
       "a stepper motor on a port, beside a camera"},
      {"serial_rail", "serial", "a made-up rail", true, {}, open_serial_rig},
#ifdef FATHOM_TEST_GIGE
      {"gige", "aravis", "Aravis's fake camera", true, {}, open_gige_rig},
#endif
#ifdef FATHOM_TEST_ALPACA
      {"alpaca", "alpaca", "an Alpaca server of the test's own", true, {}, open_alpaca_rig},
#endif
      {"gige_camera", "aravis", "FATHOM_TEST_RIG_ARAVIS", false,
       "a GigE Vision or USB3 Vision camera, and its lens"},
      {"sim_webcam", "sim", "sim:lens=webcam,noise=0,drift=0,backlash=3", true},
      {"replay", "replay", "replay:" + recorded_folder(), true},
      {"http_sim", "http", "a served sim", true, {}, open_served_sim},
      {"http_replay", "http", "a served recording", true, {}, open_served_recording},
      {"uvc", "v4l2", "FATHOM_TEST_RIG_UVC", true, "a UVC camera with a motorised focus"},
      {"vivid", "v4l2", "FATHOM_TEST_RIG_VIVID", false, "the driver vivid and a lens beside it"},
      {"indi", "indi", "FATHOM_TEST_RIG_INDI", false, "INDI simulators on a real indiserver"},
  };
  return fixtures;
}

std::string RigConformance::rig_text() const {
  const RigFixture& fixture = GetParam();
  if (fixture.needs.empty()) return fixture.text;
  const char* const text = std::getenv(fixture.text.c_str());
  return text == nullptr ? "" : text;
}

void RigConformance::SetUp() {
  if (rig_text().empty()) {
    GTEST_SKIP() << "needs " << GetParam().needs << ": tools/check --hardware brings it, and sets "
                 << GetParam().text;
  }
  rig_ = open();
}

Hardware RigConformance::open(const OpenOptions& options) const {
  const auto open_it = GetParam().open;
  return open_it != nullptr ? open_it(options) : open_hardware(rig_text(), options);
}

Frame RigConformance::grab() {
  std::optional<Frame> frame = camera().grab(5s);
  EXPECT_TRUE(frame) << "no frame within five seconds";
  return frame ? std::move(*frame) : Frame();
}

Frame RigConformance::grab_after(std::int64_t settled_ns) {
  for (int i = 0; i < 100; ++i) {
    Frame frame = grab();
    if (frame.empty() || frame.exposure.start_ns >= settled_ns) return frame;
  }
  ADD_FAILURE() << "a hundred frames, and all began before " << settled_ns << " ns";
  return Frame();
}

std::vector<std::uint32_t> pixels_of(const Frame& frame) {
  std::vector<std::uint32_t> pixels;
  for (int y = 0; y < frame.height_px(); ++y) {
    for (int x = 0; x < frame.width_px(); ++x) pixels.push_back(frame.at(x, y));
  }
  return pixels;
}

TEST(RigDrivers, EachHasAFixtureInThisSuite) {
  const auto fixtures = rig_fixtures();
  for (const RigDriver* driver : all_rig_drivers()) {
    const bool found =
        std::any_of(fixtures.begin(), fixtures.end(),
                    [&](const RigFixture& fixture) { return fixture.driver == driver->name(); });
    EXPECT_TRUE(found) << "the rig driver " << driver->name()
                       << " is not tested; add a rig of it to tests/conformance/rig/fixtures.cpp";
  }
}

TEST(RigDrivers, TellWhatTheyAreInOneLine) {
  for (const RigDriver* driver : all_rig_drivers()) {
    const std::string name = driver->name();
    EXPECT_FALSE(name.empty());
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-"), std::string::npos)
        << name;
    const std::string summary = driver->summary();
    EXPECT_FALSE(summary.empty()) << name;
    EXPECT_EQ(summary.find('\n'), std::string::npos) << name;
  }
}

}  // namespace fathom::test
