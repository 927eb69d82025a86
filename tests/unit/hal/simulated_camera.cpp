// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "hal/drivers/simulated/sensor.hpp"
#include "simulated_support.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using namespace std::chrono_literals;
using test::expect_error;
using test::pixels;
using test::SimulatedRig;

const char* const kTargets[] = {"usaf", "seedling", "orange", "blank"};

double mean(const std::vector<std::uint32_t>& values) {
  double sum = 0;
  for (const std::uint32_t value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

TEST(SimulatedCamera, EqualSeedsGiveEqualRuns) {
  for (const char* target : kTargets) {
    const std::string text = fmt::format("sim:distance=1500,start=940,target={}", target);
    SimulatedRig first(text), second(text), other(text + ",seed=7");
    for (int i = 0; i < 3; ++i) {
      const auto seen = pixels(first.grab());
      EXPECT_EQ(seen, pixels(second.grab())) << target;
      EXPECT_NE(seen, pixels(other.grab())) << target;
      EXPECT_NE(seen, pixels(first.grab())) << target << ": frames differ by their noise";
      second.grab();
      first.lens().move_to(900 + 10 * i);
      second.lens().move_to(900 + 10 * i);
    }
  }
}

TEST(SimulatedCamera, WithoutNoiseFramesAreEqual) {
  SimulatedRig rig("sim:noise=0,start=781");
  const auto seen = pixels(rig.grab());
  rig.lens().move_to(0);
  rig.lens().move_to(781);
  EXPECT_EQ(pixels(rig.grab()), seen);
}

TEST(SimulatedCamera, BlankCardIsFeatureless) {
  SimulatedRig clean("sim:target=blank,noise=0");
  const auto card = pixels(clean.grab());
  EXPECT_EQ(std::vector(card.size(), card.front()), card);
  EXPECT_EQ(card.front(), 47u) << "18 % of 240 grey values, and 4 of black level";
  SimulatedRig noisy("sim:target=blank,drift=0");
  EXPECT_NEAR(mean(pixels(noisy.grab())), 4 + 0.18 * 240, 0.1);
}

TEST(SimulatedCamera, FixedPatternStaysAndRandomNoiseAveragesOut) {
  SimulatedRig rig("sim:target=blank,drift=0");
  const auto sums = [&] {
    std::vector<double> sum(256 * 240);
    for (int frame = 0; frame < 50; ++frame) {
      const auto seen = pixels(rig.grab());
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += seen[i] / 50.0;
    }
    return sum;
  };
  const auto first = sums(), second = sums();
  double difference = 0, pattern = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    difference += std::pow(first[i] - second[i], 2) / 2 / static_cast<double>(first.size());
    pattern += std::pow(first[i] - 47.2, 2) / static_cast<double>(first.size());
  }
  // Shot noise 0.73, read noise 0.75 and rounding 0.29 make 1.09 a frame, 0.154 a mean of fifty.
  EXPECT_NEAR(std::sqrt(difference), 0.154, 0.01);
  // Offsets of 0.4 and gains of 0.4 % of 43 make 0.44, beside what is left of the random part.
  EXPECT_NEAR(std::sqrt(pattern - difference), 0.44, 0.04);
}

TEST(SimulatedCamera, ChartCoversTheDefaultWindowAtEveryDistance) {
  SimulatedRig rig("sim:noise=0");
  for (const double distance_mm : {1230.0, 1500.0, 1800.0, 2200.0, 2600.0, 3000.0}) {
    rig.stage().place_at(distance_mm);
    rig.lens().move_to(std::round(1200 * (1219 - 135) / (distance_mm - 135)));
    const Frame frame = rig.grab();
    // Every quarter of the window has black bars and white paper.
    for (const int x : {96, 128}) {
      for (const int y : {88, 120}) {
        int dark = 0, bright = 0;
        for (int i = 0; i < 32 * 32; ++i) {
          const std::uint32_t grey = frame.at(x + i % 32, y + i / 32);
          dark += grey < 60;
          bright += grey > 180;
        }
        EXPECT_GT(dark, 50) << distance_mm << " mm, " << x << ", " << y;
        EXPECT_GT(bright, 50) << distance_mm << " mm, " << x << ", " << y;
      }
    }
  }
}

TEST(SimulatedCamera, StampsFollowTheSimulatedClock) {
  SimulatedRig rig("sim");
  std::int64_t last_end_ns = -1;
  for (int i = 0; i < 20; ++i) {
    const Arrival arrival = rig.lens().move_to(10 * (i % 3));
    for (int k = 0; k < 2; ++k) {
      const Frame frame = rig.grab();
      EXPECT_GE(frame.exposure.start_ns, arrival.settled_ns);
      EXPECT_GE(frame.exposure.start_ns, last_end_ns);
      EXPECT_EQ(frame.exposure.end_ns - frame.exposure.start_ns, 20'000'000);
      EXPECT_EQ(frame.lens_position, arrival.position);
      last_end_ns = frame.exposure.end_ns;
    }
  }
  const std::int64_t before_ns = rig.lens().move_to(0).settled_ns;
  EXPECT_NEAR(static_cast<double>(rig.lens().move_to(500).settled_ns - before_ns), 20.05e9, 1);
}

TEST(SimulatedCamera, RunsAtThirtyFramesASecond) {
  SimulatedRig rig("sim:target=blank");
  const std::int64_t first_ns = rig.grab().exposure.start_ns;
  for (int i = 0; i < 29; ++i) rig.grab();
  EXPECT_NEAR(static_cast<double>(rig.grab().exposure.start_ns - first_ns), 1e9, 1e3);
}

TEST(SimulatedCamera, AFrameThatTakesTooLongComesNextTime) {
  SimulatedRig rig("sim:target=blank,exposure_ms=100");
  EXPECT_FALSE(rig.camera().grab(60ms));
  EXPECT_FALSE(rig.camera().grab(0ms));
  EXPECT_FALSE(rig.camera().grab(-5ms));
  const auto frame = rig.camera().grab(60ms);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->exposure.start_ns, 0);
  EXPECT_EQ(frame->exposure.end_ns, 100'000'000);
  EXPECT_TRUE(rig.camera().grab(std::chrono::milliseconds::max()));
}

TEST(SimulatedCamera, LongerExposuresAreBrighter) {
  SimulatedRig normal("sim:target=blank,noise=0"),
      doubled("sim:target=blank,noise=0,exposure_ms=40");
  EXPECT_NEAR(mean(pixels(doubled.grab())) - 4, 2 * (mean(pixels(normal.grab())) - 4), 1);
  SimulatedRig long_exposure("sim:target=blank,noise=0,exposure_ms=1000");
  EXPECT_EQ(mean(pixels(long_exposure.grab())), 255) << "saturated";
}

TEST(SimulatedCamera, SettingsAreCheckedBeforeTheyAreTaken) {
  SimulatedRig rig("sim:target=blank");
  Camera& camera = rig.camera();
  EXPECT_TRUE(camera.is_live());
  const CameraSettings standard{256, 240, Depth::bits8, 20};
  EXPECT_EQ(camera.settings(), standard);

  CameraSettings wished = standard;
  wished.exposure_ms = 12.5;
  EXPECT_EQ(camera.validate(wished), Validity::valid);
  camera.apply(wished);
  EXPECT_EQ(camera.settings(), wished);

  CameraSettings other{640, 480, Depth::bits16, 1e6};
  expect_error(ErrorCode::unsupported, [&] { camera.apply(other); }, {"256 x 240"});
  EXPECT_EQ(camera.validate(other), Validity::adjusted);
  EXPECT_EQ(other, (CameraSettings{256, 240, Depth::bits8, 1000}));
  camera.apply(other);

  for (const double nonsense : {0.0, -1.0, std::nan("")}) {
    CameraSettings bad = standard;
    bad.exposure_ms = nonsense;
    EXPECT_EQ(camera.validate(bad), Validity::refused);
  }
  EXPECT_EQ(camera.settings(), other);
}

TEST(SimulatedStage, ReachesItsDistancesOnly) {
  SimulatedRig rig("sim:distance=1500");
  EXPECT_EQ(rig.stage().distance_mm(), 1500);
  rig.stage().place_at(2000.5);
  EXPECT_EQ(rig.stage().distance_mm(), 2000.5);
  for (const double wrong : {1000.0, 10001.0, std::nan("")}) {
    expect_error(ErrorCode::out_of_bounds, [&] { rig.stage().place_at(wrong); }, {"1230", "10000"});
  }
  EXPECT_EQ(rig.stage().distance_mm(), 2000.5);
}

TEST(SimulatedStage, APlacedTargetIsTheOneThatWasOpenedThere) {
  SimulatedRig placed("sim:noise=0,target=seedling,distance=1500,start=800"),
      opened("sim:noise=0,target=seedling,distance=1750,start=800");
  placed.grab();
  placed.stage().place_at(1750);
  EXPECT_EQ(pixels(placed.grab()), pixels(opened.grab()));
}

TEST(SimulatedDriver, RefusesWrongKeysAndValues) {
  const auto refuses = [](const char* text, std::initializer_list<const char*> texts) {
    expect_error(
        ErrorCode::bad_argument, [&] { open_hardware(text); }, texts);
  };
  refuses("sim:target=apple", {"target", "usaf, seedling, orange, blank"});
  refuses("sim:distance=1000", {"distance", "1230"});
  refuses("sim:distance=far", {"distance", "far"});
  refuses("sim:noise=-1", {"noise"});
  refuses("sim:drift=nan", {"drift"});
  refuses("sim:seed=1.5", {"seed"});
  refuses("sim:start=1201", {"start", "1200"});
  refuses("sim:rate=0", {"rate"});
  refuses("sim:fnumber=1", {"fnumber", "2.8"});
  refuses("sim:backlash=-1", {"backlash"});
  refuses("sim:lose=x", {"lose"});
  refuses("sim:exposure_ms=0", {"exposure_ms"});
  refuses("sim:colour=red", {"colour", "target"});
}

TEST(SimulatedLamp, WandersWithinOnePercentOverMinutes) {
  const simulated::Lamp lamp(1989, 1);
  double lowest = 2, highest = 0;
  for (int second = 0; second < 3600; ++second) {
    const double light = lamp.light_at(std::int64_t{1'000'000'000} * second);
    const double a_second_later = lamp.light_at(std::int64_t{1'000'000'000} * (second + 1));
    EXPECT_LT(std::abs(a_second_later - light), 0.0003) << "slow";
    lowest = std::min(lowest, light);
    highest = std::max(highest, light);
  }
  EXPECT_GT(lowest, 0.99);
  EXPECT_LT(lowest, 0.994);
  EXPECT_LT(highest, 1.01);
  EXPECT_GT(highest, 1.006);
}

/// Also prints what a frame costs: searches take thousands.
TEST(SimulatedCamera, EveryLensPositionIsAnotherPicture) {
  for (const char* target : {"usaf", "seedling", "orange"}) {
    SimulatedRig rig(fmt::format("sim:noise=0,target={}", target));
    auto last = pixels(rig.grab());
    std::chrono::duration<double, std::milli> taken{};
    for (int i = 1; i <= 20; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      rig.lens().move_to(50 * i);
      const Frame frame = rig.grab();
      taken += std::chrono::steady_clock::now() - begin;
      EXPECT_NE(pixels(frame), std::exchange(last, pixels(frame))) << target << ' ' << 50 * i;
    }
    fmt::print("{}: {:.1f} ms a frame\n", target, taken.count() / 20);
  }
}

}  // namespace
}  // namespace fathom
