// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/serial/serial_lens.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "engine/error.hpp"
#include "hal/approach.hpp"
#include "hal/clock.hpp"
#include "hal/drivers/serial/serial_motion.hpp"

namespace fathom::serial {
namespace {

constexpr double kMostSteps = 1e9;

std::filesystem::path state_path(const Settings& settings) {
  return settings.state.empty() ? default_state_path("serial " + settings.port)
                                : std::filesystem::path(settings.state);
}

}  // namespace

SerialLens::SerialLens(const Settings& settings, StopRequests stop_requests)
    : settings_(settings),
      stop_requests_(std::move(stop_requests)),
      device_(std::make_unique<Device>(settings_)) {
  info_.description = device_->name();
  info_.unit = settings_.profile.unit;
  info_.resolution = settings_.profile.step;
  info_.lowest = settings_.lowest ? *settings_.lowest : device_->lowest();
  info_.highest = settings_.highest ? *settings_.highest : device_->highest();
  const double travel = info_.highest - info_.lowest;
  if (!(travel >= info_.resolution) || !(travel <= kMostSteps * info_.resolution)) {
    throw Error(
        ErrorCode::bad_data,
        fmt::format("{} says that it may travel from {} to {} {}, in steps of {}; say "
                    "lowest, highest and step",
                    device_->name(), info_.lowest, info_.highest, info_.unit, info_.resolution));
  }
  settings_.traits.describe(info_);
  rests_since_ns_ = monotonic_now_ns();
  recall();
}

/// Where a device that forgets stood when it was left.
void SerialLens::recall() {
  if (!settings_.profile.forgets) return;
  const Owner owner{fmt::format("{}, {} to {} {} in steps of {}", device_->name(), info_.lowest,
                                info_.highest, info_.unit, info_.resolution),
                    0, step_at(info_.highest), takeup()};
  whereabouts_ = std::make_unique<Whereabouts>(state_path(settings_), owner);
  const auto& known = whereabouts_->standing();
  if (!known) return;
  if (const std::string why = device_->why_unknown(); !why.empty()) {
    whereabouts_->leave(why);
  } else {
    device_->count_from(place(known->position));
  }
}

int SerialLens::step_at(double position) const {
  const double most = std::floor((info_.highest - info_.lowest) / info_.resolution + 1e-6);
  return static_cast<int>(
      std::clamp(std::round((position - info_.lowest) / info_.resolution), 0.0, most));
}

int SerialLens::takeup() const {
  return static_cast<int>(std::ceil(settings_.traits.backlash / info_.resolution - 1e-9));
}

void SerialLens::fail_unknown(const std::string& why) const {
  const bool can_home = settings_.profile.home.has_value();
  const char* const look =
      settings_.profile.forgets ? "; look at it and type: fathom rigs home RIG --at POSITION" : "";
  throw Error(ErrorCode::unavailable,
              fmt::format("where the lens stands is not known: {}{}{}", why, look,
                          can_home ? "; let it find its home: fathom rigs home RIG" : ""));
}

void SerialLens::require_its_own() const {
  if (voyage_ == nullptr) return;
  throw Error(ErrorCode::unavailable,
              "the lens belongs to a motion that was started; end that first");
}

Standing SerialLens::standing() const {
  if (whereabouts_) {
    if (const std::string why = device_->why_unknown(); !why.empty()) {
      whereabouts_->leave(why);
      fail_unknown(why);
    }
    if (!whereabouts_->standing()) fail_unknown(whereabouts_->reason());
    return *whereabouts_->standing();
  }
  if (const std::string why = device_->why_unknown(); !why.empty()) fail_unknown(why);
  const double at = device_->position();
  const double beyond = std::max(info_.lowest - at, at - info_.highest);
  if (beyond > info_.resolution / 2) {
    throw Error(ErrorCode::out_of_bounds,
                fmt::format("{} stands at {} {}, outside of {} to {}; bring it there, or say other "
                            "limits",
                            device_->name(), at, info_.unit, info_.lowest, info_.highest));
  }
  const int step = step_at(at);
  return {step, approached_ == step || takeup() == 0};
}

double SerialLens::position() const {
  if (voyage_ != nullptr && !voyage_->is_over()) {
    throw Error(ErrorCode::unavailable,
                "the lens is on its way; wait until it has arrived, or ask its motion");
  }
  return place(standing().position);
}

Trip SerialLens::plan(double position) const {
  require_its_own();
  require_within(info_, position);
  const StopWatch watch(stop_requests_);
  const Standing from = standing();
  const int to = step_at(position);
  auto legs = approach_moves(from.is_approached, from.position, to, takeup(), 0);
  return {from, to, std::move(legs), watch};
}

void SerialLens::leave(const Trip& trip) {
  approached_.reset();
  if (!whereabouts_ || trip.legs.empty()) return;
  whereabouts_->leave(
      fmt::format("moving from {} to {}", place(trip.from.position), place(trip.to)));
}

void SerialLens::arrive(const Standing& standing) {
  if (whereabouts_) whereabouts_->arrive(standing);
  approached_ = standing.is_approached ? std::optional(standing.position) : std::nullopt;
}

std::unique_ptr<SerialMotion> SerialLens::begin(Trip trip) {
  const Standing from = trip.from;
  const bool stays = trip.legs.empty();
  if (!stays) leave(trip);
  try {
    return std::make_unique<SerialMotion>(*this, std::move(trip));
  } catch (const Error& error) {
    // What is refused before it begins has moved nothing.
    if (!stays && error.code() == ErrorCode::unsupported) arrive(from);
    throw;
  }
}

Arrival SerialLens::move_to(double position) { return begin(plan(position))->wait(); }

std::string SerialLens::why_unwatched() const {
  if (settings_.profile.tells_on_way) return {};
  return fmt::format("{} does not say where it is on its way", settings_.profile.name);
}

std::unique_ptr<Motion> SerialLens::start(double position) {
  if (!settings_.profile.tells_on_way) return Lens::start(position);
  return begin(plan(position));
}

Arrival SerialLens::home() {
  require_its_own();
  if (!settings_.profile.home) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} has no home to look for{}", settings_.profile.name,
                            settings_.profile.forgets
                                ? "; look at it and type: fathom rigs home RIG --at POSITION"
                                : ""));
  }
  const StopWatch watch(stop_requests_);
  if (whereabouts_) whereabouts_->leave("going home");
  approached_.reset();
  const std::int64_t started_ns = monotonic_now_ns();
  const auto limit_ns = static_cast<std::int64_t>(settings_.home_s * 1e9);
  const std::int64_t until_ns = started_ns + limit_ns;
  device_->send_home();
  while (device_->look().is_moving) {
    const bool is_late = monotonic_now_ns() >= until_ns;
    if (is_late || watch.stopped()) {
      device_->halt();
      if (!is_late) throw Error(ErrorCode::cancelled, "stopped on the way home");
      throw Error(ErrorCode::timeout, fmt::format("{} did not find its home within {} s; home_s = "
                                                  "SECONDS waits longer",
                                                  device_->name(), settings_.home_s));
    }
    sleep_until_ns(monotonic_now_ns() + 20'000'000);
  }
  if (whereabouts_) {
    device_->count_from(settings_.home_position);
    whereabouts_->arrive({step_at(settings_.home_position), false});
  }
  Arrival arrival = move_to(info_.lowest);
  arrival.started_ns = started_ns;
  return arrival;
}

void SerialLens::declare_at(double position) {
  require_its_own();
  require_within(info_, position);
  if (!whereabouts_) {
    throw Error(
        ErrorCode::unsupported,
        fmt::format("{} counts by itself where it is; it cannot be told", info_.description));
  }
  // A power cut must not bring back what is on the disk now: it is wrong, or nobody would say so.
  whereabouts_->leave("being told where it stands");
  device_->found_again();
  if (const std::string why = device_->why_unknown(); !why.empty()) {
    throw Error(
        ErrorCode::unavailable,
        fmt::format("{}: it will not move until it has found its home: fathom rigs home RIG", why));
  }
  const int step = step_at(position);
  device_->count_from(place(step));
  // Whichever way it was brought there, the play may be on the wrong side.
  arrive({step, takeup() == 0});
}

}  // namespace fathom::serial
