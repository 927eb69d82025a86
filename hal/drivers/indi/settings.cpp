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

std::optional<int> integer_if_given(const RigSettings& settings, const std::string& key, int lowest,
                                    int highest) {
  const auto value = static_cast<int>(settings.integer(key, lowest, lowest, highest));
  return settings.has(key) ? std::optional(value) : std::nullopt;
}

std::optional<double> number_if_given(const RigSettings& settings, const std::string& key,
                                      double lowest, double highest) {
  const double value = settings.number(key, lowest, lowest, highest);
  return settings.has(key) ? std::optional(value) : std::nullopt;
}

CameraWishes read_camera(const RigSettings& settings) {
  CameraWishes wishes;
  wishes.exposure_ms = number_if_given(settings, "exposure_ms", 0.001, kHour_ms);
  wishes.longest_exposure_ms = settings.number("longest_exposure_ms", kHour_ms, 0.001, kHour_ms);
  wishes.x = integer_if_given(settings, "x", 0, kWidestChip_px);
  wishes.y = integer_if_given(settings, "y", 0, kWidestChip_px);
  wishes.width = integer_if_given(settings, "width", 1, kWidestChip_px);
  wishes.height = integer_if_given(settings, "height", 1, kWidestChip_px);
  wishes.binning = integer_if_given(settings, "binning", 1, 64);
  wishes.gain = number_if_given(settings, "gain", -1e6, 1e6);
  return wishes;
}

FocuserWishes read_focuser(const RigSettings& settings) {
  FocuserWishes wishes;
  wishes.start = number_if_given(settings, "start", 0, kMostSteps);
  wishes.travel = number_if_given(settings, "travel", 1, kMostSteps);
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
  read.server = parse_address(settings.text("server", "localhost:7624"));
  read.camera = settings.text("camera", "");
  read.focuser = settings.text("focuser", "");
  read.polling_ms = number_if_given(settings, "polling_ms", 1, 60'000);
  read.timeout_ns =
      static_cast<std::int64_t>(settings.number("timeout_s", 10, 0.1, 600) * kSecond_ns);
  read.camera_wishes = read_camera(settings);
  read.focuser_wishes = read_focuser(settings);
  return read;
}

}  // namespace fathom::indi
