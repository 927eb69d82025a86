// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/alpaca/settings.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/error.hpp"

namespace fathom::alpaca {
namespace {

constexpr double kSecond_ns = 1e9;
constexpr double kHour_ms = 3.6e6;
constexpr int kLargestSide = 100'000;
constexpr double kFarthest = 1e9;

Address server_of(const RigSettings& settings) {
  const std::string text = settings.text("server", "localhost");
  if (const auto address = parse_address(text, kUsualPort)) return *address;
  throw Error(ErrorCode::bad_argument,
              fmt::format("\"{}\" is no Alpaca server; write HOST or HOST:PORT, such as "
                          "localhost:11111",
                          text));
}

}  // namespace

Settings Settings::read(const RigSettings& settings) {
  Settings read;
  read.server = server_of(settings);
  read.camera = settings.text("camera", "");
  read.focuser = settings.text("focuser", "");
  read.timeout_ns = std::llround(settings.number("timeout_s", 10, 0.05, 600) * kSecond_ns);
  read.camera_keys = {.exposure_ms = settings.number_if_given("exposure_ms", 0.001, kHour_ms),
                      .binning = settings.integer_if_given("binning", 1, kLargestSide),
                      .x = settings.integer_if_given("x", 0, kLargestSide),
                      .y = settings.integer_if_given("y", 0, kLargestSide),
                      .width = settings.integer_if_given("width", 1, kLargestSide),
                      .height = settings.integer_if_given("height", 1, kLargestSide),
                      .gain = settings.number_if_given("gain", -kFarthest, kFarthest)};
  const LensTraits usual{
      .settle_ms = 200, .backlash = 0, .coarse_spacing = 0, .blur_px = {}, .optics = {}};
  read.focuser_keys = {
      .lowest = settings.number_if_given("lowest", 0, kFarthest),
      .highest = settings.number_if_given("highest", 0, kFarthest),
      .start = settings.number_if_given("start", 0, kFarthest),
      .travel = settings.number_if_given("travel", 1, kFarthest),
      .stall_ns = std::llround(settings.number("stall_s", 10, 0.1, 3600) * kSecond_ns),
      .traits = LensTraits::read(settings, usual)};
  return read;
}

}  // namespace fathom::alpaca
