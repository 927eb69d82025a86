// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/alpaca/focuser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "engine/error.hpp"
#include "hal/approach.hpp"
#include "hal/clock.hpp"

namespace fathom::alpaca {
namespace {

constexpr std::int64_t kPoll_ns = 20'000'000;
constexpr double kFarthest = 1e9;

}  // namespace

AlpacaFocuser::AlpacaFocuser(std::unique_ptr<Connection> connection, std::string device,
                             const FocuserKeys& keys, StopRequests stop_requests)
    : connection_(std::move(connection)),
      device_(std::move(device)),
      keys_(keys),
      stop_requests_(std::move(stop_requests)) {
  connect();
  describe();
}

void AlpacaFocuser::connect() {
  if (!connection_->flag(device_, "connected")) {
    connection_->put(device_, "connected", "Connected=True");
    restorer_.at_end([this] { connection_->put(device_, "connected", "Connected=False"); });
  }
  // What moves it by itself when it gets colder is an automatic focus.
  if (!connection_->flag(device_, "tempcompavailable") || !connection_->flag(device_, "tempcomp"))
    return;
  restorer_.at_end([this] { connection_->put(device_, "tempcomp", "TempComp=True"); });
  connection_->put(device_, "tempcomp", "TempComp=False");
}

void AlpacaFocuser::describe() {
  is_absolute_ = connection_->flag(device_, "absolute");
  const double most_step = connection_->number(device_, "maxstep");
  const double most_at_once = connection_->number(device_, "maxincrement");
  if (!(most_step >= 1 && most_step <= kFarthest) || !(most_at_once >= 1)) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} at {} says that it travels {} steps, {} at once", device_,
                            connection_->address().text(), most_step, most_at_once));
  }
  if (!is_absolute_ && !keys_.travel) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} at {} is a relative focuser: say how far out it can go with "
                            "travel=STEPS, and where it stands with start=STEPS",
                            device_, connection_->address().text()));
  }
  most_at_once_ = static_cast<int>(std::min(most_at_once, kFarthest));
  info_.description =
      fmt::format("alpaca {} ({} at {}){}", connection_->text(device_, "name"), device_,
                  connection_->address().text(), is_absolute_ ? "" : ", relative");
  info_.unit = "steps";
  const double last = is_absolute_ ? most_step : *keys_.travel;
  info_.lowest = keys_.lowest.value_or(0);
  info_.highest = std::floor(std::min(keys_.highest.value_or(last), last));
  if (!(info_.lowest < info_.highest)) {
    throw Error(ErrorCode::unsupported, fmt::format("{}: lowest and highest leave no travel within "
                                                    "its 0 to {}",
                                                    info_.description, last));
  }
  if (!is_absolute_ && keys_.start) declare_at(*keys_.start);
  keys_.traits.describe(info_);
}

double AlpacaFocuser::position() const {
  if (is_absolute_) {
    const double position = connection_->number(device_, "position");
    if (std::abs(position) <= kFarthest) return position;
    throw Error(ErrorCode::bad_data,
                fmt::format("{} says that it stands at {}", info_.description, position));
  }
  if (counted_) return *counted_;
  throw Error(ErrorCode::unavailable,
              fmt::format("nobody knows where {} stands: say start=STEPS (0 is its inner stop), or "
                          "send it home",
                          info_.description));
}

void AlpacaFocuser::declare_at(double position) {
  if (is_absolute_) return Lens::declare_at(position);
  require_within(info_, position);
  counted_ = static_cast<int>(nearest(position));
  approached_.reset();
}

/// Nobody knows from which side it came to where it was found.
std::vector<int> AlpacaFocuser::legs(int from, int to) const {
  const auto takeup = static_cast<int>(std::lround(keys_.traits.backlash));
  const auto lowest = static_cast<int>(info_.lowest);
  return approach_moves(approached_ == from, from, to, takeup, lowest);
}

Arrival AlpacaFocuser::move_to(double position) {
  require_within(info_, position);
  const StopWatch stop(stop_requests_);
  const std::int64_t started_ns = monotonic_now_ns();
  const std::vector<int> moves =
      legs(static_cast<int>(std::lround(this->position())), static_cast<int>(nearest(position)));
  approached_.reset();  // until it has arrived
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (i > 0) rest(monotonic_now_ns() + keys_.traits.settle_ns(), stop);
    go_by(moves[i], stop);
  }
  approached_ = static_cast<int>(std::lround(this->position()));
  return settled(started_ns, stop);
}

/// No more at once than the driver takes.
void AlpacaFocuser::go_by(int steps, const StopWatch& stop) {
  auto place = static_cast<int>(std::lround(position()));
  const int goal = place + steps;
  while (place != goal) {
    const int next = place + std::clamp(goal - place, -most_at_once_, most_at_once_);
    drive(place, next, stop);
    place = next;
  }
}

void AlpacaFocuser::drive(int from, int to, const StopWatch& stop) {
  if (!is_absolute_) counted_.reset();  // until it has arrived
  connection_->put(device_, "move", fmt::format("Position={}", is_absolute_ ? to : to - from));
  try {
    await_rest(to, stop);
  } catch (...) {
    halt();
    throw;
  }
  if (!is_absolute_) counted_ = to;
}

/// Progress is only what brings it nearer. A relative one does not tell its place: each part of its way
/// has to be over by then.
void AlpacaFocuser::await_rest(int to, const StopWatch& stop) {
  double nearest = kFarthest * 2;
  std::int64_t progress_ns = monotonic_now_ns();
  while (true) {
    const bool is_moving = connection_->flag(device_, "ismoving");
    const double left = is_absolute_ ? std::abs(position() - to) : 0;
    if (!is_moving && left <= accuracy_of(info_)) return;
    if (left < nearest) {
      nearest = left;
      progress_ns = monotonic_now_ns();
    }
    if (monotonic_now_ns() - progress_ns > keys_.stall_ns) {
      throw Error(ErrorCode::device_lost,
                  fmt::format("{} was sent to {} and comes no nearer ({}); is it blocked? "
                              "stall_s=SECONDS waits longer",
                              info_.description, to,
                              is_moving ? "it still moves, it says" : "it stands, it says"));
    }
    rest(monotonic_now_ns() + kPoll_ns, stop);
  }
}

void AlpacaFocuser::halt() noexcept {
  try {
    connection_->put(device_, "halt", "");
  } catch (...) {  // some cannot; their way ends by itself
  }
}

void AlpacaFocuser::rest(std::int64_t until_ns, const StopWatch& stop) {
  for (std::int64_t now_ns = monotonic_now_ns(); now_ns < until_ns; now_ns = monotonic_now_ns()) {
    if (stop.stopped()) throw Error(ErrorCode::cancelled, "the focuser was stopped on request");
    sleep_until_ns(std::min(until_ns, now_ns + kPoll_ns));
  }
}

Arrival AlpacaFocuser::settled(std::int64_t started_ns, const StopWatch& stop) {
  const std::int64_t stopped_ns = monotonic_now_ns();
  rest(stopped_ns + keys_.traits.settle_ns(), stop);
  return {.position = position(),
          .started_ns = started_ns,
          .stopped_ns = stopped_ns,
          .settled_ns = monotonic_now_ns()};
}

/// A relative one goes inward as far as it could ever have been out; its stop holds it.
Arrival AlpacaFocuser::home() {
  if (is_absolute_) return move_to(info_.lowest);
  const StopWatch stop(stop_requests_);
  const std::int64_t started_ns = monotonic_now_ns();
  approached_.reset();
  counted_ = static_cast<int>(*keys_.travel);
  go_by(-static_cast<int>(*keys_.travel), stop);
  counted_ = 0;
  if (info_.lowest > 0) go_by(static_cast<int>(info_.lowest), stop);
  return settled(started_ns, stop);
}

}  // namespace fathom::alpaca
