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
constexpr std::int64_t kBelief_ns = 500'000'000;  // what is said and does not change
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

void IndiFocuser::rest(std::int64_t until_ns, const StopWatch& stop) {
  const auto never = [] { return false; };
  if (client_->wait(never, until_ns, &stop) != Waited::stopped) return;
  throw Error(
      ErrorCode::cancelled,
      fmt::format("stopped on request while the focuser settled; it stands at {}", position()));
}

Arrival IndiFocuser::settled(std::int64_t started_ns, const StopWatch& stop) {
  const std::int64_t stopped_ns = monotonic_now_ns();
  rest(stopped_ns + wishes_.traits.settle_ns(), stop);
  return {.position = position(),
          .started_ns = started_ns,
          .stopped_ns = stopped_ns,
          .settled_ns = monotonic_now_ns()};
}

/// Nobody knows from which side it came to where it was found, or where somebody else has moved it.
std::vector<int> IndiFocuser::legs(int from, int to) const {
  const auto takeup = static_cast<int>(std::lround(wishes_.traits.backlash));
  const auto lowest = static_cast<int>(info_.lowest);
  return approach_moves(approached_ == from, from, to, takeup, lowest);
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
    // A driver may say that it is there while the motor still runs; it must not turn too early.
    if (place != from) rest(monotonic_now_ns() + wishes_.traits.settle_ns(), stop);
    place += steps;
    is_absolute_ ? go_to(place, stop) : go_by(steps, stop);
  }
  approached_ = static_cast<int>(std::lround(this->position()));
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

void IndiFocuser::drive(double target, double sent, const StopWatch& stop) {
  client_->drain();
  const double from = position();
  const Property& property = client_->need(device_, kAbsolute);
  const MoveOrder order{.goal = target,
                        .from = from,
                        .accuracy = accuracy_of(info_),
                        .before = property.serial,
                        .rest_ns = std::min(kBelief_ns, client_->timeout_ns()),
                        .now_ns = monotonic_now_ns()};
  client_->send_numbers(property, std::vector<NumberWish>{{kAbsoluteValue, sent}});
  await_arrival(kAbsolute, order, stop);
}

/// Where it comes to rest beside its goal, it is sent once more, and as much farther. A driver that
/// is beside its goal then too is inexact by chance, and is taken as it is.
void IndiFocuser::go_to(double target, const StopWatch& stop) {
  const auto within = [&](double place) { return std::clamp(place, info_.lowest, info_.highest); };
  drive(target, within(target + aim_), stop);
  const double beside = target - position();
  const bool has_room = within(target + beside) == target + beside;
  if (std::abs(beside) < 0.5 || is_aimed_ || !has_room) return;
  is_aimed_ = true;
  drive(target, target + beside, stop);
  if (std::abs(target - position()) < 0.5) aim_ = beside;
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
    const MoveOrder order{.goal = std::nullopt,
                          .steps = part,
                          .before = property.serial,
                          .rest_ns = std::min(kBelief_ns, client_->timeout_ns()),
                          .now_ns = monotonic_now_ns()};
    client_->send_numbers(property, std::vector<NumberWish>{{kRelativeValue, part}});
    await_arrival(kRelative, order, stop);
    left -= part;
  }
  counted_ = counted;
}

double IndiFocuser::said_in(const Property& property, const MoveOrder& order) const {
  if (order.goal) return counted_by_driver();
  return property.values.empty() ? std::nan("") : property.values.front().number;
}

/// Some drivers say nothing at all until they have arrived.
std::int64_t IndiFocuser::patience_ns(const MoveWatch& move) const {
  return move.thinks_done() ? std::min(client_->timeout_ns(), wishes_.stall_ns) : wishes_.stall_ns;
}

/// Waits until the driver says that it is done and, where it counts, stands at the target.
void IndiFocuser::await_arrival(const char* name, const MoveOrder& order, const StopWatch& stop) {
  MoveWatch move(order);
  MoveWord word = MoveWord::nothing;
  for (std::int64_t heard_ns = order.now_ns;;) {
    const auto says_something = [&] {
      const Property& property = client_->need(device_, name);
      const std::int64_t now_ns = monotonic_now_ns();
      word = move.heed(property, said_in(property, order), now_ns);
      return word != MoveWord::nothing || now_ns >= heard_ns + patience_ns(move);
    };
    const Waited waited = client_->wait(says_something, heard_ns + wishes_.stall_ns, &stop);
    const bool is_late = waited != Waited::stopped && word == MoveWord::nothing;
    if (word == MoveWord::arrived && waited != Waited::stopped) return;
    if (is_late && move.thinks_done() && move.is_beside()) return;
    if (word == MoveWord::progress && waited != Waited::stopped) {
      heard_ns = monotonic_now_ns();
      continue;
    }
    const std::string words = client_->words_of(device_);
    bring_to_rest(name, order.before);
    if (waited == Waited::stopped) {
      throw Error(ErrorCode::cancelled, "a move of the focuser was stopped on request");
    }
    fail(word, order, move, words);
  }
}

/// Says why a move ended before its goal. words: the driver's own.
void IndiFocuser::fail(MoveWord word, const MoveOrder& order, const MoveWatch& move,
                       const std::string& words) {
  const std::string way = order.goal ? fmt::format(" on its way to {}", *order.goal) : "";
  if (word == MoveWord::failed) {
    throw Error(ErrorCode::device_lost,
                fmt::format("{} failed to move{}", info_.description, words));
  }
  if (word == MoveWord::nonsense) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} says that it stands at {} steps{}{}; look at it, and at its driver",
                            info_.description, move.said(), way, words));
  }
  if (order.goal && move.thinks_done()) {
    throw Error(ErrorCode::device_lost,
                fmt::format("{} stopped at {}{}, and says that it is done{}; is it blocked, or "
                            "does its travel end there?",
                            info_.description, move.said(), way, words));
  }
  throw Error(
      ErrorCode::device_lost,
      fmt::format("{} made no progress for {} s{}{}; is it blocked, or slow to report? "
                  "stall_s=SECONDS waits longer",
                  info_.description, static_cast<double>(patience_ns(move)) * 1e-9, way, words));
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
  const StopWatch again(stop_requests_);
  client_->wait(rests, monotonic_now_ns() + (abort != nullptr ? kRest_ns : wishes_.stall_ns),
                &again);
}

}  // namespace fathom::indi
