// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/serial/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "hal/drivers/serial/port.hpp"

namespace fathom::serial {
namespace {

constexpr double kFarthest = 1e9;
constexpr std::uintmax_t kLargestProfile = 1 << 18;

std::string required(const RigSettings& settings, const char* key, const std::string& what) {
  std::string value = settings.text(key, "");
  if (!value.empty()) return value;
  throw Error(ErrorCode::bad_argument,
              fmt::format("{}: {} is missing: {}", settings.where(), key, what));
}

std::string profile_names() {
  std::vector<std::string_view> names;
  for (const KnownProfile& profile : known_profiles()) names.push_back(profile.name);
  return fmt::format("{}, or the path of a .toml file", fmt::join(names, ", "));
}

/// The text of a profile that comes with the program, or of a file.
std::string profile_text(const RigSettings& settings, const std::string& name) {
  for (const KnownProfile& profile : known_profiles()) {
    if (profile.name == name) return std::string(profile.text);
  }
  if (name.ends_with(".toml")) return read_file(name, kLargestProfile);
  throw Error(ErrorCode::bad_argument, fmt::format("{}: there is no profile \"{}\"; there are {}",
                                                   settings.where(), name, profile_names()));
}

Profile read_profile_for(const RigSettings& settings, const std::string& name) {
  const std::string text = profile_text(settings, name);
  Variables values;
  for (const auto& [variable, fallback] : variables_of(text, name)) {
    values[variable] = settings.text(variable, fallback);
  }
  Profile profile = read_profile(text, name, values);
  profile.unit = settings.text("unit", profile.unit);
  profile.step = settings.number("step", profile.step, 1e-9, kFarthest);
  profile.scale = settings.number("scale", profile.scale, -kFarthest, kFarthest);
  profile.baud = static_cast<int>(settings.integer("baud", profile.baud, 300, 4'000'000));
  if (profile.scale == 0 || !is_known_speed(profile.baud)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{}: scale must not be 0, and baud must be a speed of a serial port",
                            settings.where()));
  }
  return profile;
}

void require_travel(const RigSettings& settings, const Settings& read) {
  const Profile& profile = read.profile;
  if ((!read.lowest && !profile.lowest) || (!read.highest && !profile.highest)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{}: lowest and highest are missing, in {}: {} does not tell how far "
                            "it may travel",
                            settings.where(), profile.unit, profile.name));
  }
  if (read.lowest && read.highest && !(*read.lowest < *read.highest)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{}: lowest={} must be below highest={}", settings.where(),
                            *read.lowest, *read.highest));
  }
}

}  // namespace

Settings Settings::read(const RigSettings& settings) {
  Settings read;
  read.port = required(settings, "port", "a serial port such as /dev/ttyUSB0");
  read.profile_name = settings.text("profile", "");
  // A rig file makes every path one of its folder, and a name is none.
  if (const auto slash = read.profile_name.rfind('/');
      slash != std::string::npos && !read.profile_name.ends_with(".toml")) {
    read.profile_name.erase(0, slash + 1);
  }
  if (read.profile_name.empty()) required(settings, "profile", profile_names());
  read.profile = read_profile_for(settings, read.profile_name);
  read.lowest = settings.number_if_given("lowest", -kFarthest, kFarthest);
  read.highest = settings.number_if_given("highest", -kFarthest, kFarthest);
  require_travel(settings, read);
  if (read.profile.forgets) {
    read.home_position =
        settings.number("home_position", read.lowest.value_or(0), -kFarthest, kFarthest);
    read.state = settings.text("state", "");
  }
  read.stall_s = settings.number("stall_s", read.stall_s, 0.1, 3600);
  read.home_s = settings.number("home_s", read.home_s, 0.1, 3600);
  read.traits = LensTraits::read(
      settings, {.settle_ms = 50, .backlash = 0, .coarse_spacing = 0, .blur_px = {}, .optics = {}});
  return read;
}

}  // namespace fathom::serial
