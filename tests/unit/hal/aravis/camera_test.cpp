// SPDX-License-Identifier: Apache-2.0
// A camera that does what it should.
#include <algorithm>
#include <mutex>
#include <vector>

#include "hal/clock.hpp"
#include "hal/drivers/aravis/settings.hpp"
#include "hal/rig_text.hpp"
#include "support.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

// Registers of Aravis' fake camera.
constexpr std::uint32_t kWidth = 0x100, kHeight = 0x104, kExposure = 0x120, kFormat = 0x128,
                        kOffsetX = 0x130, kGain = 0x110, kGainAuto = 0x114, kPeriod = 0x138,
                        kTriggerMode = 0x300, kTriggerSource = 0x304;

Painter ramp() {
  return [](int x, int y) { return static_cast<std::uint8_t>(3 * x + y); };
}

TEST(AravisCamera, IsFoundAndGivesWhatItSees) {
  FakeGige fake;
  fake.paint(ramp);
  const Hardware rig = open_camera(gige());
  EXPECT_EQ(rig.camera->settings(), (CameraSettings{64, 48, Depth::bits8, 10}));
  EXPECT_FALSE(rig.camera->streams());
  EXPECT_TRUE(rig.camera->is_live());
  const Frame frame = next_frame(*rig.camera);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) ASSERT_EQ(frame.at(x, y), (3u * x + y) & 255) << x << " " << y;
  EXPECT_EQ(rig.camera->counts(), (FrameCounts{1, 0, 0}));
  EXPECT_NE(rig.camera->description().find("triggered"), std::string::npos);
}

TEST(AravisCamera, IsListedAndOpenedByTheNameThatTheListSays) {
  const FakeGige fake;
  std::string text;
  for (const RigDriver* driver : all_rig_drivers()) {
    if (std::string(driver->name()) != "aravis") continue;
    EXPECT_EQ(driver->obstacle(), "");
    for (const FoundHardware& found : driver->find()) {
      if (found.description.find("TEST1") != std::string::npos) text = found.text;
    }
  }
  ASSERT_NE(text, "");
  EXPECT_NO_THROW(open_camera(text));
}

TEST(AravisCamera, GivesSixteenBitsAndOneColourOfAMosaic) {
  FakeGige fake;
  fake.paint(ramp);
  const Frame wide = next_frame(*open_camera(gige(",format=Mono16")).camera);
  EXPECT_EQ(wide.depth(), Depth::bits16);
  EXPECT_EQ(wide.at(5, 7), 22u * 256);
  const Frame red = next_frame(*open_camera(gige(",format=BayerRG8,bayer=red")).camera);
  EXPECT_EQ(red.width_px(), 32);
  EXPECT_EQ(red.height_px(), 24);
  EXPECT_EQ(red.at(5, 7), 3u * 10 + 14);
  const Frame luma = next_frame(*open_camera(gige(",format=BayerGB8")).camera);
  EXPECT_EQ(luma.width_px(), 64);
  EXPECT_NEAR(luma.at(20, 10), 70, 1);  // a ramp is the mean of its neighbours
}

/// When each picture was begun, by the grey that it is painted with.
class Diary {
 public:
  Painter begin() {
    const std::scoped_lock lock(mutex_);
    begun_ns_.push_back(monotonic_now_ns());
    const auto grey = static_cast<std::uint8_t>(begun_ns_.size() % 256);
    return [grey](int, int) { return grey; };
  }
  std::int64_t begun_ns(const Frame& frame) {
    const std::scoped_lock lock(mutex_);
    return begun_ns_.at((frame.at(0, 0) + 255u) % 256);
  }

 private:
  std::mutex mutex_;
  std::vector<std::int64_t> begun_ns_;
};

TEST(AravisCamera, AFrameIsBegunWhenItIsAskedForAndNotBefore) {
  FakeGige fake;
  Diary diary;
  fake.paint([&] { return diary.begin(); });
  const Hardware rig = open_camera(gige());
  for (int i = 0; i < 5; ++i) {
    const std::int64_t asked_ns = monotonic_now_ns();
    const Frame frame = next_frame(*rig.camera);
    EXPECT_GE(frame.exposure.start_ns, asked_ns);
    EXPECT_LE(frame.exposure.start_ns, diary.begun_ns(frame));
    EXPECT_LE(frame.exposure.end_ns, monotonic_now_ns());
  }
}

/// Frames that wait in a queue are as old as they say, whichever clock tells.
TEST(AravisCamera, AFrameThatCameByItselfIsStampedEarlyAndNeverLate) {
  for (const bool has_clock : {false, true}) {
    FakeGige fake(has_clock);
    Diary diary;
    fake.paint([&] { return diary.begin(); });
    const Hardware rig = open_camera(gige(",trigger=off,fps=50"));
    EXPECT_TRUE(rig.camera->streams());
    std::int64_t earliest_ns = 0;
    for (int i = 0; i < 20; ++i) {
      if (i == 10) sleep_until_ns(monotonic_now_ns() + 300'000'000);
      const Frame frame = next_frame(*rig.camera);
      const std::int64_t begun_ns = diary.begun_ns(frame);
      EXPECT_LE(frame.exposure.start_ns, begun_ns) << has_clock << " " << i;
      earliest_ns = std::max(earliest_ns, begun_ns - frame.exposure.start_ns);
    }
    EXPECT_LT(earliest_ns, 2'000'000'000) << has_clock;
  }
}

TEST(AravisCamera, LeavesEverythingAsItWas) {
  FakeGige fake;
  fake.write(kGainAuto, 2);  // continuous
  fake.write(kOffsetX, 8);
  const std::uint32_t registers[] = {kWidth, kHeight, kExposure, kFormat,      kOffsetX,
                                     kGain,  kPeriod, kGainAuto, kTriggerMode, kTriggerSource};
  std::vector<std::uint32_t> before;
  for (const std::uint32_t address : registers) before.push_back(fake.read(address));
  {
    const Hardware rig = open_camera(gige(",x=16,exposure_ms=4,gain=3,format=Mono16,fps=20"));
    EXPECT_EQ(fake.read(kGainAuto), 1u);  // off
    EXPECT_EQ(fake.read(kExposure), 4000u);
    EXPECT_EQ(fake.read(kOffsetX), 16u);
    EXPECT_EQ(fake.read(kTriggerMode), 1u);
    next_frame(*rig.camera);
  }
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(fake.read(registers[i]), before[i]) << std::hex << registers[i];
}

TEST(AravisCamera, TakesNewSettingsAndGivesFramesOfThem) {
  FakeGige fake;
  fake.paint(ramp);
  const Hardware rig = open_camera(gige());
  CameraSettings wished{100, 60, Depth::bits16, 2.5};
  EXPECT_EQ(rig.camera->validate(wished), Validity::valid);
  rig.camera->apply(wished);
  EXPECT_EQ(rig.camera->settings(), wished);
  const Frame frame = next_frame(*rig.camera);
  EXPECT_EQ(frame.width_px(), 100);
  EXPECT_EQ(frame.depth(), Depth::bits16);
  EXPECT_EQ(fake.read(kExposure), 2500u);
}

TEST(AravisCamera, RefusesWhatItCannotKeepAndSaysWhatItCan) {
  const FakeGige fake;
  const auto refused = [](const std::string& keys, std::initializer_list<const char*> words,
                          ErrorCode code = ErrorCode::unsupported) {
    expect_error(
        code, [&] { open_camera(gige(keys)); }, words);
  };
  refused(",format=Mono12p", {"format=Mono12p", "Mono8", "Mono16"});
  refused(",x=5000", {"OffsetX", "5000", "2048"});
  refused(",exposure_ms=999999", {"exposure"});
  refused(",gain=1000", {"gain=1000", "0 to"});
  refused(",colour=red", {"colour", "bayer"}, ErrorCode::bad_argument);
  refused(",exposure_ms=nan", {"exposure_ms"}, ErrorCode::bad_argument);
  expect_error(ErrorCode::unavailable, [] { open_camera("aravis:127.0.0.77"); },
               {"127.0.0.77", "rigs list"});
}

TEST(AravisCamera, TheRigFilesOfTheExamplesAreRead) {
  const std::string path = FATHOM_EXAMPLE_RIGS "/machine-vision.toml";
  const RigRequest request = parse_rig(path);
  EXPECT_STREQ(request.camera.driver->name(), "aravis");
  EXPECT_NO_THROW(aravis::Settings::read(request.camera.settings));
  EXPECT_NO_THROW(request.camera.settings.require_all_used());
}

}  // namespace
}  // namespace fathom::test
