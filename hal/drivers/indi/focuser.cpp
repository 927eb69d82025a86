// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/focuser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "hal/approach.hpp"
#include "hal/clock.hpp"

namespace fathom::indi {
namespace {

constexpr const char* kRelativeValue = "FOCUS_RELATIVE_POSITION";
constexpr std::int64_t kBelief_ns = 500'000'000;  // an arrival without a move before it
constexpr std::int64_t kRest_ns = 2'000'000'000;

}  // namespace

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
  return {.position = position(),
          .started_ns = started_ns,
          .stopped_ns = stopped_ns,
          .settled_ns = monotonic_now_ns()};
}

/// Nobody knows from which side it came to where it was found, or where somebody else has moved it.
std::vector<int> IndiFocuser::legs(int from, int to) const {
  const auto takeup = static_cast<int>(std::lround(wishes_.traits.backlash));
  const auto lowest = static_cast<int>(info_.lowest);
  return approached_ == from ? approach_moves(from, to, takeup, lowest)
                             : approach_moves_in_doubt(from, to, takeup, lowest);
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
