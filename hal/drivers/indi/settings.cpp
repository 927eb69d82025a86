// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/settings.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"

namespace fathom::indi {
namespace {

constexpr double kSecond_ns = 1e9;
constexpr int kWidestChip_px = 100'000;
constexpr double kHour_ms = 3.6e6;
constexpr double kMostSteps = 1e9;

Address server_of(const RigSettings& settings) {
  const std::string text = settings.text("server", "localhost");
  const std::optional<Address> address = parse_address(text, kUsualPort);
  if (address) return *address;
  throw Error(ErrorCode::bad_argument,
              fmt::format("\"{}\" is no INDI server; write HOST or HOST:PORT, such as "
                          "localhost:7624, and more keys as indi:server=HOST:PORT,key=value",
                          text));
}

CameraWishes read_camera(const RigSettings& settings) {
  CameraWishes wishes;
  wishes.exposure_ms = settings.number_if_given("exposure_ms", 0.001, kHour_ms);
  wishes.longest_exposure_ms = settings.number("longest_exposure_ms", kHour_ms, 0.001, kHour_ms);
  wishes.x = settings.integer_if_given("x", 0, kWidestChip_px);
  wishes.y = settings.integer_if_given("y", 0, kWidestChip_px);
  wishes.width = settings.integer_if_given("width", 1, kWidestChip_px);
  wishes.height = settings.integer_if_given("height", 1, kWidestChip_px);
  wishes.binning = settings.integer_if_given("binning", 1, 64);
  wishes.gain = settings.number_if_given("gain", -1e6, 1e6);
  return wishes;
}

FocuserWishes read_focuser(const RigSettings& settings) {
  FocuserWishes wishes;
  wishes.start = settings.number_if_given("start", 0, kMostSteps);
  wishes.travel = settings.number_if_given("travel", 1, kMostSteps);
  wishes.home = settings.flag("home", false);
  wishes.stall_ns =
      static_cast<std::int64_t>(settings.number("stall_s", 20, 0.1, 3600) * kSecond_ns);
  wishes.traits = LensTraits::read(settings, {});
  return wishes;
}

}  // namespace

IndiSettings IndiSettings::read(const RigSettings& settings) {
  IndiSettings read;
  read.where = settings.where();
  read.server = server_of(settings);
  read.camera = settings.text("camera", "");
  read.focuser = settings.text("focuser", "");
  read.polling_ms = settings.number_if_given("polling_ms", 1, 60'000);
  read.timeout_ns =
      static_cast<std::int64_t>(settings.number("timeout_s", 10, 0.1, 600) * kSecond_ns);
  read.camera_wishes = read_camera(settings);
  read.focuser_wishes = read_focuser(settings);
  return read;
}

}  // namespace fathom::indi
