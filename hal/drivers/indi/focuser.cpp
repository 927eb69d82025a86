// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/focuser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "engine/error.hpp"
#include "hal/approach.hpp"
#include "hal/clock.hpp"

namespace fathom::indi {
namespace {

constexpr const char* kAbsolute = "ABS_FOCUS_POSITION";
constexpr const char* kAbsoluteValue = "FOCUS_ABSOLUTE_POSITION";
constexpr const char* kRelative = "REL_FOCUS_POSITION";
constexpr const char* kRelativeValue = "FOCUS_RELATIVE_POSITION";
constexpr std::int64_t kQuiet_ns = 150'000'000;
constexpr std::int64_t kLoudest_ns = 2'000'000'000;
constexpr std::int64_t kBelief_ns = 500'000'000;  // an arrival without a move before it
constexpr std::int64_t kRest_ns = 2'000'000'000;
constexpr double kMostSteps = 1e9;

bool holds(std::string text, const char* word) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text.find(word) != std::string::npos;
}

/// The switch that a driver calls one of many names; null for a property that is none.
const Value* compensation_off(const Property& property) {
  if (property.kind != Kind::toggle || !holds(property.name, "COMP")) return nullptr;
  if (!holds(property.name, "TEMP") && !holds(property.name, "T. ")) return nullptr;
  const auto off = std::find_if(
      property.values.begin(), property.values.end(),
      [](const Value& value) { return holds(value.name, "DISABLE") || holds(value.name, "OFF"); });
  return off == property.values.end() ? nullptr : &*off;
}

}  // namespace

IndiFocuser::IndiFocuser(std::unique_ptr<Client> client, std::string device,
                         const IndiSettings& settings, StopRequests stop_requests)
    : client_(std::move(client)),
      device_(std::move(device)),
      stop_requests_(std::move(stop_requests)),
      wishes_(settings.focuser_wishes),
      changes_(*client_, device_) {
  const auto has_motion = [&] {
    return client_->devices().find(device_, kAbsolute) != nullptr ||
           client_->devices().find(device_, kRelative) != nullptr;
  };
  if (client_->wait(has_motion, monotonic_now_ns() + client_->timeout_ns()) == Waited::late) {
    throw Error(ErrorCode::timeout,
                fmt::format("{} at {} has neither {} nor {} after {} s; is it a focuser?", device_,
                            client_->where(), kAbsolute, kRelative,
                            static_cast<double>(client_->timeout_ns()) * 1e-9));
  }
  client_->wait_until_quiet(kQuiet_ns, kLoudest_ns);
  prepare(settings);
  if (!is_absolute_ && wishes_.home) home();
}

void IndiFocuser::prepare(const IndiSettings& settings) {
  is_absolute_ = client_->devices().find(device_, kAbsolute) != nullptr;
  info_.description = fmt::format("INDI focuser {} at {}, {}", device_, client_->where(),
                                  is_absolute_ ? "absolute" : "relative");
  info_.unit = "steps";
  info_.resolution = 1;
  if (is_absolute_) {
    const Value* const value = client_->need(device_, kAbsolute).find(kAbsoluteValue);
    if (value != nullptr) info_.lowest = value->lowest, info_.highest = value->highest;
    refuse_relative_keys(settings.where);
  } else {
    client_->await(device_, "FOCUS_MOTION");
    info_.highest = travel();
    counted_ = wishes_.start;
    if (counted_) require_within(info_, *counted_);
  }
  if (const Property* const most = client_->devices().find(device_, "FOCUS_MAX")) {
    const Value* const value = most->find("FOCUS_MAX_VALUE");
    if (value != nullptr && value->number > 0) {
      info_.highest = std::min(info_.highest, value->number);
    }
  }
  if (!(info_.lowest >= -kMostSteps && info_.highest <= kMostSteps &&
        info_.highest - info_.lowest >= 1)) {
    throw Error(ErrorCode::bad_data, fmt::format("{} says that it travels from {} to {} steps",
                                                 info_.description, info_.lowest, info_.highest));
  }
  info_.lowest = std::ceil(info_.lowest);
  info_.highest = std::floor(info_.highest);
  wishes_.traits.describe(info_);
  if (settings.polling_ms) {
    client_->await(device_, "POLLING_PERIOD");
    changes_.set_numbers("POLLING_PERIOD", {{"PERIOD_MS", *settings.polling_ms}});
  }
  hold_still();
}

void IndiFocuser::refuse_relative_keys(const std::string& where) const {
  const char* const key = wishes_.start    ? "start"
                          : wishes_.home   ? "home"
                          : wishes_.travel ? "travel"
                                           : nullptr;
  if (key == nullptr) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("{}: {} means nothing to {}: an absolute focuser counts by itself; leave "
                          "the key out",
                          where, key, info_.description));
}

void IndiFocuser::hold_still() {
  std::vector<std::pair<std::string, std::string>> switches;
  for (const auto& [key, property] : client_->devices().all()) {
    const Value* const off = key.first == device_ ? compensation_off(property) : nullptr;
    if (off != nullptr) switches.emplace_back(property.name, off->name);
  }
  for (const auto& [property, value] : switches) changes_.set_switch(property, value);
}

double IndiFocuser::travel() const {
  if (wishes_.travel) return *wishes_.travel;
  const Property* const most = client_->devices().find(device_, "FOCUS_MAX");
  const Value* const value = most == nullptr ? nullptr : most->find("FOCUS_MAX_VALUE");
  if (value != nullptr && value->number > kMostSteps) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} says that it travels {} steps", info_.description, value->number));
  }
  if (value != nullptr && value->number >= 1) return value->number;
  throw Error(ErrorCode::unsupported,
              fmt::format("{} does not say how far it travels; add travel=STEPS, from its inner "
                          "stop to its outer one",
                          info_.description));
}

double IndiFocuser::counted_by_driver() const {
  const Value* const value = client_->need(device_, kAbsolute).find(kAbsoluteValue);
  return value == nullptr ? std::nan("") : value->number;
}

double IndiFocuser::position() const {
  client_->drain();
  if (is_absolute_) {
    const double position = counted_by_driver();
    if (std::abs(position) <= kMostSteps) return position;
    if (!std::isnan(position)) {
      throw Error(ErrorCode::bad_data,
                  fmt::format("{} says that it stands at {} steps", info_.description, position));
    }
    throw Error(ErrorCode::unavailable,
                fmt::format("{} does not know where it stands; calibrate or home it in another "
                            "program",
                            info_.description));
  }
  client_->need(device_, kRelative);
  if (counted_) return *counted_;
  throw Error(ErrorCode::unavailable,
              fmt::format("nobody knows where {} stands: say start=STEPS (0 is its inner stop), or "
                          "home=true to drive it there first",
                          info_.description));
}

void IndiFocuser::declare_at(double position) {
  if (is_absolute_) return Lens::declare_at(position);
  require_within(info_, position);
  counted_ = nearest(position);
  approached_.reset();
}

Arrival IndiFocuser::settled(std::int64_t started_ns, const StopWatch& stop) {
  const std::int64_t stopped_ns = monotonic_now_ns();
  const auto never = [] { return false; };
  if (client_->wait(never, stopped_ns + wishes_.traits.settle_ns(), &stop) == Waited::stopped) {
    throw Error(
        ErrorCode::cancelled,
        fmt::format("stopped on request while the focuser settled; it stands at {}", position()));
  }
  return {position(), monotonic_now_ns(), "", started_ns, stopped_ns};
}

/// Nobody knows from which side it came to where it was found, or where somebody else has moved it.
std::vector<int> IndiFocuser::legs(int from, int to) const {
  const auto takeup = static_cast<int>(std::lround(wishes_.traits.backlash));
  const auto lowest = static_cast<int>(info_.lowest);
  const int turn = std::max(to - takeup, lowest);
  if (approached_ == from || from <= turn) return approach_moves(from, to, takeup, lowest);
  std::vector<int> moves{turn - from};
  if (to > turn) moves.push_back(to - turn);
  return moves;
}

Arrival IndiFocuser::move_to(double position) {
  require_within(info_, position);
  const StopWatch stop(stop_requests_);
  const std::int64_t started_ns = monotonic_now_ns();
  const auto from = static_cast<int>(std::lround(this->position()));
  const auto to = static_cast<int>(nearest(position));
  const std::vector<int> moves = legs(from, to);
  approached_.reset();  // until it has arrived
  double place = from;
  for (const int steps : moves) {
    place += steps;
    is_absolute_ ? go_to(place, stop) : go_by(steps, stop);
  }
  approached_ = to;
  return settled(started_ns, stop);
}

Arrival IndiFocuser::home() {
  if (is_absolute_) return move_to(info_.lowest);
  const StopWatch stop(stop_requests_);
  const std::int64_t started_ns = monotonic_now_ns();
  approached_.reset();
  counted_ = 0;  // only so that the steps below can be counted: nobody asks before they are made
  go_by(-travel(), stop);
  counted_ = info_.lowest;
  return settled(started_ns, stop);
}

void IndiFocuser::go_to(double target, const StopWatch& stop) {
  client_->drain();
  const Property& property = client_->need(device_, kAbsolute);
  const std::uint64_t before = property.serial;
  client_->send_numbers(property, std::vector<NumberWish>{{kAbsoluteValue, target}});
  await_arrival(kAbsolute, before, target, stop);
}

void IndiFocuser::go_by(double steps, const StopWatch& stop) {
  const double counted = *counted_ + steps;
  counted_.reset();  // until it has arrived
  client_->set_switch(device_, "FOCUS_MOTION", steps < 0 ? "FOCUS_INWARD" : "FOCUS_OUTWARD");
  const Value* const limits = client_->need(device_, kRelative).find(kRelativeValue);
  const double most =
      limits != nullptr && limits->highest >= 1 ? std::floor(limits->highest) : kMostSteps;
  for (double left = std::abs(steps); left > 0;) {
    const double part = std::min(left, most);
    client_->drain();
    const Property& property = client_->need(device_, kRelative);
    const std::uint64_t before = property.serial;
    client_->send_numbers(property, std::vector<NumberWish>{{kRelativeValue, part}});
    await_arrival(kRelative, before, std::nullopt, stop);
    left -= part;
  }
  counted_ = counted;
}

/// Waits until the driver says that it is done and, where it counts, stands at the target. What it
/// says without a change of state or place is no progress: a blocked motor may be reported for
/// ever. A driver that does not count may repeat the end of the part before; so it is believed only
/// once it has been busy, or has had a while to become so.
void IndiFocuser::await_arrival(const char* name, std::uint64_t before,
                                std::optional<double> target, const StopWatch& stop) {
  const std::int64_t believed_ns = monotonic_now_ns() + std::min(kBelief_ns, client_->timeout_ns());
  const auto is_done = [&](const Property& property) {
    if (property.serial == before || property.state == State::busy) return false;
    if (target) return std::abs(counted_by_driver() - *target) < 0.5;
    return property.busy_serial > before || monotonic_now_ns() >= believed_ns;
  };
  for (;;) {
    const Property seen = client_->need(device_, name);
    const auto has_moved = [&] {
      const Property& now = client_->need(device_, name);
      return is_done(now) || now.state != seen.state ||
             (!now.values.empty() && now.values[0].number != seen.values[0].number);
    };
    if (seen.serial != before && seen.state == State::alert) {
      const std::string why = client_->words_of(device_);
      bring_to_rest(name, before);
      throw Error(ErrorCode::device_lost,
                  fmt::format("{} failed to move{}", info_.description, why));
    }
    if (is_done(seen)) return;
    // Some drivers say nothing at all until they have arrived.
    const bool may_be_moving = seen.serial == before || seen.state == State::busy;
    const std::int64_t patience_ns = may_be_moving ? wishes_.stall_ns : client_->timeout_ns();
    const Waited waited = client_->wait(has_moved, monotonic_now_ns() + patience_ns, &stop);
    if (waited == Waited::done) continue;
    const std::string words = client_->words_of(device_);
    bring_to_rest(name, before);
    if (waited == Waited::stopped) {
      throw Error(ErrorCode::cancelled, "a move of the focuser was stopped on request");
    }
    throw Error(ErrorCode::device_lost,
                fmt::format("{} made no progress for {} s{}{}; is it blocked, or slow to report? "
                            "stall_s=SECONDS waits longer",
                            info_.description, static_cast<double>(patience_ns) * 1e-9,
                            target ? fmt::format(" on its way to {}", *target) : "", words));
  }
}

/// Where a driver cannot abort, its move is waited out, so that the motor stands all the same.
void IndiFocuser::bring_to_rest(const char* name, std::uint64_t before) {
  const Property* const abort = client_->devices().find(device_, "FOCUS_ABORT_MOTION");
  const std::uint64_t unanswered = abort != nullptr ? abort->serial : 0;
  if (abort != nullptr) client_->send_switch(*abort, "ABORT");
  const auto rests = [&] {
    const Property& property = client_->need(device_, name);
    const Property* const answer = client_->devices().find(device_, "FOCUS_ABORT_MOTION");
    if (answer != nullptr && answer->serial == unanswered) return false;
    return property.serial != before && property.state != State::busy;
  };
  client_->wait(rests, monotonic_now_ns() + (abort != nullptr ? kRest_ns : wishes_.stall_ns));
}

}  // namespace fathom::indi
