// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/stepper/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"

namespace fathom::stepper {
namespace {

constexpr double kUsualRate = 25;   // what the thesis used,
constexpr double kUsualLimit = 40;  // and where its motor stalled (T10)
constexpr double kSlowest = 0.01;
constexpr double kFastest = 100'000;
constexpr int kFarthest = 10'000'000;
constexpr std::string_view kLevels[] = {"high", "low"};

int steps(const RigSettings& settings, const char* key, int fallback) {
  return static_cast<int>(settings.integer(key, fallback, -kFarthest, kFarthest));
}

std::int64_t microseconds(const RigSettings& settings, const char* key, double fallback) {
  constexpr double kLongest_us = 1e6;
  return std::llround(1000 * settings.number(key, fallback, 0, kLongest_us));
}

bool level(const RigSettings& settings, const char* key, const char* fallback) {
  return settings.choice(key, fallback, kLevels) == "high";
}

std::string required(const RigSettings& settings, const char* key, const char* what) {
  std::string value = settings.text(key, "");
  if (!value.empty()) return value;
  throw Error(ErrorCode::bad_argument,
              fmt::format("{}: {} is missing: {}", settings.where(), key, what));
}

GpioPins read_gpio(const RigSettings& settings) {
  static constexpr std::string_view kPulls[] = {"up", "down", "none"};
  GpioPins pins;
  pins.chip = settings.text("chip", pins.chip);
  pins.step = required(settings, "step", "the number or name of the GPIO line wired to STEP");
  pins.direction = required(settings, "dir", "the number or name of the GPIO line wired to DIR");
  pins.home = settings.text("home", "");
  pins.home_pull = settings.choice("home_pull", pins.home_pull, kPulls);
  return pins;
}

ParallelPins read_parallel(const RigSettings& settings, const std::string& port) {
  ParallelPins pins;
  pins.path = port;
  pins.step_bit = static_cast<int>(settings.integer("step_bit", 0, 0, 7));
  pins.direction_bit = static_cast<int>(settings.integer("dir_bit", 1, 0, 7));
  if (settings.has("home")) pins.home = settings.choice("home", "", kStatusLines);
  if (pins.step_bit != pins.direction_bit) return pins;
  throw Error(ErrorCode::bad_argument,
              fmt::format("{}: step_bit and dir_bit are both {}", settings.where(), pins.step_bit));
}

/// step_on says at which change of STEP the board makes its step.
Pulse read_pulse(const RigSettings& settings) {
  static constexpr std::string_view kEdges[] = {"rise", "fall", "toggle"};
  Pulse pulse;
  const std::string edge = settings.choice("step_on", "rise", kEdges);
  pulse.rest = edge == "toggle" ? StepRest() : StepRest(edge == "fall");
  pulse.up_level = level(settings, "out", "high");
  pulse.width_ns = microseconds(settings, "pulse_us", 100);
  pulse.setup_ns = microseconds(settings, "setup_us", 100);
  pulse.hold_ns = microseconds(settings, "hold_us", 100);
  return pulse;
}

Pace read_pace(const RigSettings& settings, const Pulse& pulse) {
  const double limit = settings.number("limit", kUsualLimit, kSlowest, kFastest);
  const double rate = settings.number("rate", std::min(kUsualRate, limit), kSlowest, kFastest);
  const double acceleration = settings.number("accel", 0, 0, 1e9);
  const double start_rate = settings.number("start_rate", 0, 0, rate);
  if (rate > limit) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{}: rate={} steps/s is above limit={}, where the motor stalls; the "
                            "nearest is rate={}",
                            settings.where(), rate, limit, limit));
  }
  if (settings.has("start_rate") && acceleration == 0) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{}: start_rate is where a ramp begins, and accel gives none",
                            settings.where()));
  }
  const double levels_us = (pulse.rest ? 2.0 : 1.0) * static_cast<double>(pulse.width_ns) / 1000;
  if (levels_us * rate > 1e6) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{}: {} steps/s leave no time for pulses of pulse_us={}; the nearest "
                            "is pulse_us={}",
                            settings.where(), rate, pulse.width_ns / 1000,
                            std::floor(1e6 / rate / (pulse.rest ? 2 : 1))));
  }
  return Pace(rate, acceleration, start_rate);
}

HomeBy read_home_by(const RigSettings& settings, bool has_switch) {
  static constexpr std::string_view kWays[] = {"none", "stop", "switch"};
  const std::string way = settings.choice("home_by", has_switch ? "switch" : "none", kWays);
  if (way == "switch" && !has_switch) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{}: home_by=switch needs home, the line that the switch is wired to",
                            settings.where()));
  }
  return way == "none" ? HomeBy::nobody : way == "stop" ? HomeBy::stop : HomeBy::by_switch;
}

Homing read_homing(const RigSettings& settings, const Settings& read, bool has_switch) {
  Homing homing;
  homing.by = read_home_by(settings, has_switch);
  homing.end = steps(settings, "home_position", read.lowest);
  homing.closed_level = level(settings, "home_when", "low");
  const double rate = read.pace.rate();
  homing.pace = read.pace.limited_to(settings.number("home_rate", rate / 2, kSlowest, rate));
  const int span = read.highest - homing.end;
  homing.margin =
      static_cast<int>(settings.integer("home_margin", std::max(10, span / 20), 1, kFarthest));
  homing.span = span;
  if (homing.end > read.lowest) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{}: home_position={} is above lowest={}: the lens cannot go beyond "
                            "its end",
                            settings.where(), homing.end, read.lowest));
  }
  return homing;
}

/// Positions nearer to a switch than the play could not be approached from below: nobody said that
/// there is room beyond it. (Against a mechanical end, the end takes the place of the approach.)
void require_room(const RigSettings& settings, const Settings& read) {
  const int backlash = read.backlash_steps();
  if (read.homing.by != HomeBy::by_switch || read.lowest - read.homing.end >= backlash) return;
  throw Error(ErrorCode::unsupported,
              fmt::format("{}: backlash={} needs as much room between the switch at "
                          "home_position={} and lowest={}; the nearest is lowest={}, or "
                          "home_position={} if the switch is moved",
                          settings.where(), backlash, read.homing.end, read.lowest,
                          read.homing.end + backlash, read.lowest - backlash));
}

}  // namespace

int Settings::backlash_steps() const { return static_cast<int>(std::ceil(traits.backlash)); }

std::string Settings::identity(const std::string& lines_name) const {
  const char* const edge = !pulse.rest ? "every change" : *pulse.rest ? "fall" : "rise";
  return fmt::format("{}, {} to {} from an end at {}, out is {}, a step at every {}", lines_name,
                     lowest, highest, homing.end, pulse.up_level ? "high" : "low", edge);
}

Settings Settings::read(const RigSettings& settings) {
  Settings read;
  const std::string port =
      required(settings, "port", "\"gpio\", or a parallel port such as /dev/parport0");
  read.is_gpio = port == "gpio";
  if (read.is_gpio) {
    read.gpio = read_gpio(settings);
  } else {
    read.parallel = read_parallel(settings, port);
  }
  read.pulse = read_pulse(settings);
  read.pace = read_pace(settings, read.pulse);
  read.lowest = steps(settings, "lowest", read.lowest);
  read.highest = steps(settings, "highest", read.highest);
  if (read.lowest >= read.highest) {
    throw Error(ErrorCode::bad_argument, fmt::format("{}: lowest={} must be below highest={}",
                                                     settings.where(), read.lowest, read.highest));
  }
  read.traits = LensTraits::read(
      settings,
      {.settle_ms = 100, .backlash = 0, .coarse_spacing = 0, .blur_px = {}, .optics = {}});
  if (read.traits.backlash > read.highest - read.lowest) {
    throw Error(ErrorCode::bad_argument, fmt::format("{}: backlash={} is more than the travel",
                                                     settings.where(), read.traits.backlash));
  }
  const bool has_switch = !(read.is_gpio ? read.gpio.home : read.parallel.home).empty();
  read.homing = read_homing(settings, read, has_switch);
  require_room(settings, read);
  read.state = settings.text("state", "");
  return read;
}

}  // namespace fathom::stepper
