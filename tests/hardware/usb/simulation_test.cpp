// SPDX-License-Identifier: Apache-2.0
// What the simulated devices simulate, without a driver.
#include <gtest/gtest.h>

#include <cmath>

#include "focus_motor.hpp"
#include "pixel_format.hpp"
#include "scene.hpp"
#include "stepper.hpp"

namespace fathom::usb {
namespace {

double variance_of_steps(const Picture& picture) {
  double sum = 0;
  for (std::size_t i = 1; i < picture.pixels.size(); ++i) {
    const double step = picture.pixels[i] - picture.pixels[i - 1];
    sum += step * step;
  }
  return sum / static_cast<double>(picture.pixels.size());
}

TEST(UsbScene, GetsSofterWithEveryBitOfBlur) {
  BlurredScene scene(make_scene("texture", 7, 128, 96));
  double last = INFINITY;
  for (double sigma_px = 0.25; sigma_px < 16; sigma_px += 0.25) {
    const double now = variance_of_steps(scene.at(sigma_px));
    EXPECT_LT(now, last) << sigma_px;
    last = now;
  }
}

TEST(UsbScene, BlursAPointToItsStandardDeviationInBothDirections) {
  constexpr int side = 129, middle = 64;
  Picture point{side, side, std::vector<std::uint16_t>(side * side)};
  point.pixels[middle * side + middle] = 65535;
  for (const double sigma_px : {0.8, 1.5, 2.75, 4.0}) {
    const Picture soft = blurred(point, sigma_px);
    double sum = 0, across = 0, down = 0;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const double value = soft.pixels[static_cast<std::size_t>(y * side + x)];
        sum += value;
        across += value * (x - middle) * (x - middle);
        down += value * (y - middle) * (y - middle);
      }
    }
    EXPECT_NEAR(std::sqrt(across / sum), sigma_px, 0.03 * sigma_px);
    EXPECT_NEAR(std::sqrt(down / sum), sigma_px, 0.03 * sigma_px);
    EXPECT_NEAR(sum, 65535, 0.02 * 65535);
  }
}

TEST(UsbScene, DiffersByItsSeedAndOnlyByIt) {
  const Picture one = make_scene("texture", 1, 64, 48);
  EXPECT_EQ(one.pixels, make_scene("texture", 1, 64, 48).pixels);
  EXPECT_NE(one.pixels, make_scene("texture", 2, 64, 48).pixels);
  EXPECT_THROW(make_scene("/no/such.pgm", 1, 64, 48), std::runtime_error);
}

TEST(UsbPixels, HaveTheDepthOfTheirFormat) {
  const Picture picture{2, 2, {0, 0x1234, 0xabcd, 0xffff}};
  const auto pixels = [&](const std::string& name) {
    for (const PixelFormat& format : pixel_formats()) {
      if (format.name == name) return encode(format, picture, {});
    }
    return Bytes{};
  };
  EXPECT_EQ(pixels("GREY"), (Bytes{0, 0x12, 0xab, 0xff}));
  EXPECT_EQ(pixels("Y16"), (Bytes{0, 0, 0x34, 0x12, 0xcd, 0xab, 0xff, 0xff}));
  EXPECT_EQ(pixels("Y12"), (Bytes{0, 0, 0x23, 0x01, 0xbc, 0x0a, 0xff, 0x0f}));
  EXPECT_EQ(pixels("Y10"), (Bytes{0, 0, 0x48, 0x00, 0xaf, 0x02, 0xff, 0x03}));
  EXPECT_EQ(pixels("YUYV"), (Bytes{0, 128, 0x12, 128, 0xab, 128, 0xff, 128}));
  EXPECT_EQ(pixels("NV12"), (Bytes{0, 0x12, 0xab, 0xff, 128, 128}));
}

TEST(UsbPixels, AreAsNoisyAsTold) {
  const Picture grey{100, 100, std::vector<std::uint16_t>(10000, 0x8000)};
  Development noisy;
  noisy.noise = 4;
  const Bytes bytes = encode(pixel_formats()[0], grey, noisy);
  double sum = 0, squares = 0;
  for (const std::uint8_t byte : bytes) sum += byte, squares += byte * byte;
  const double mean = sum / 1e4;
  EXPECT_NEAR(mean, 127.5, 0.3);
  EXPECT_NEAR(std::sqrt(squares / 1e4 - mean * mean), 4, 0.2);
}

constexpr std::int64_t ms = 1'000'000;

TEST(UsbFocusMotor, StartsLateMovesAtItsSpeedAndRingsOut) {
  FocusMotor motor({.start = 100, .speed_per_s = 1000, .delay_ms = 10, .ringing = 5});
  motor.command(200, 1000 * ms);
  EXPECT_EQ(motor.position_at(900 * ms), 100);
  EXPECT_EQ(motor.position_at(1010 * ms), 100);
  EXPECT_NEAR(motor.position_at(1060 * ms), 150, 1e-9);
  EXPECT_GT(motor.position_at(1113 * ms), 202);
  EXPECT_NEAR(motor.position_at(1500 * ms), 200, 1e-3);
  motor.command(0, 1510 * ms);
  EXPECT_NEAR(motor.position_at(1060 * ms), 150, 1e-9) << "the past stays as it was";
}

struct StepperModel : testing::Test {
  Stepper motor{{.start_steps = 10,
                 .least_steps = 0,
                 .most_steps = 20,
                 .home_steps = 3,
                 .most_steps_per_s = 100,
                 .settle_us = 5,
                 .backlash_steps = 2,
                 .log = {}}};
  std::int64_t now = 0;
  void go(bool forward, int steps, std::int64_t period_ns = 20 * ms) {
    motor.set(Stepper::direction, forward, now);
    now += ms;
    for (int i = 0; i < steps; ++i) {
      motor.set(Stepper::step, true, now);
      motor.set(Stepper::step, false, now + period_ns / 2);
      now += period_ns;
    }
  }
};

TEST_F(StepperModel, StopsAtItsEndsAndLagsByItsPlay) {
  go(true, 5);
  EXPECT_EQ(motor.carriage_at(now), 15);
  go(false, 2);
  EXPECT_EQ(motor.carriage_at(now), 15);
  go(false, 20);
  EXPECT_EQ(motor.carriage_at(now), 2);
  EXPECT_FALSE(motor.get(Stepper::home));
  EXPECT_NE(motor.status().find("motor=0 "), std::string::npos);
  EXPECT_NE(motor.status().find("lost=7"), std::string::npos);
}

TEST_F(StepperModel, LosesStepsThatComeTooFastOrTooSoonAfterATurnOrWhileItIsOff) {
  go(true, 4, 5 * ms);
  EXPECT_NE(motor.status().find("motor=11 "), std::string::npos) << motor.status();
  now += 100 * ms;
  motor.set(Stepper::direction, false, now);
  motor.set(Stepper::step, true, now + 1000);
  EXPECT_NE(motor.status().find("motor=11 "), std::string::npos) << motor.status();
  motor.set(Stepper::step, false, now + ms);
  motor.set(Stepper::enable, true, now + ms);
  now += 100 * ms;
  go(false, 3);
  EXPECT_NE(motor.status().find("motor=11 "), std::string::npos) << motor.status();
}

}  // namespace
}  // namespace fathom::usb
