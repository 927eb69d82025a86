// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/serial/serial_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/error.hpp"
#include "hal/approach.hpp"
#include "hal/clock.hpp"

namespace fathom::serial {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kBelief_ns = kSecond_ns * 3 / 10;  // what is said so long is believed
constexpr std::int64_t kLongest_ns = 900 * kSecond_ns;    // of a move that tells nothing on its way
constexpr std::int64_t kHalt_ns = 10 * kSecond_ns;        // to come to rest
constexpr std::int64_t kPause_ns = kSecond_ns / 200;      // between two questions

}  // namespace

Voyage::Voyage(SerialLens& lens, Trip trip)
    : lens_(lens),
      trip_(std::move(trip)),
      goal_(trip_.from.position),
      track_(lens.place(trip_.from.position), trip_.from.is_approached,
             lens.settings_.traits.backlash, lens.info_.resolution, lens.rests_since_ns_) {
  arrival_.started_ns = monotonic_now_ns();
  said_ = lens_.place(goal_);
  lens_.voyage_ = this;
  try {
    if (trip_.legs.empty()) {
      arrival_.position = lens_.place(trip_.to);
      arrival_.stopped_ns = arrival_.settled_ns = arrival_.started_ns;
      track_.rest();
      is_over_ = true;
    } else {
      begin_leg();
    }
  } catch (...) {  // a constructor that throws has no destructor
    lens_.voyage_ = nullptr;
    throw;
  }
}

Voyage::~Voyage() {
  wishes_stop_ = true;
  const std::int64_t until_ns = monotonic_now_ns() + 2 * kHalt_ns;
  while (!is_over_ && monotonic_now_ns() < until_ns) {
    advance();
    if (!is_over_) sleep_until_ns(monotonic_now_ns() + kPause_ns);
  }
  lens_.voyage_ = nullptr;
}

void Voyage::begin_leg() {
  goal_ += trip_.legs[leg_];
  const std::int64_t now_ns = monotonic_now_ns();
  least_ = std::abs(lens_.place(goal_) - said_);
  quantum_ = std::max(1e-3 * least_, lens_.info_.resolution / 2);
  began_ns_ = progress_ns_ = unchanged_since_ns_ = now_ns;
  if (leg_ == 0) track_.depart(now_ns);
  lens_.device_->send_to(lens_.place(goal_));
}

/// A device may say that it rests before it has begun: beside its goal it is believed only after a
/// while.
bool Voyage::is_at_rest(const Look& look, std::int64_t now_ns) {
  if (look.position && *look.position != said_) {
    said_ = *look.position;
    unchanged_since_ns_ = now_ns;
  }
  if (look.is_moving) return false;
  if (!look.position) return true;
  const double beside = std::abs(said_ - lens_.place(goal_));
  const bool is_there = !is_halted_ && beside < 0.75 * lens_.info_.resolution;
  return is_there || now_ns - unchanged_since_ns_ >= kBelief_ns;
}

void Voyage::heed_progress(const Look& look, std::int64_t now_ns) {
  const double left = std::abs(said_ - lens_.place(goal_));
  if (look.position && left <= least_ - quantum_) {
    least_ = left;
    progress_ns_ = now_ns;
  }
  // One that tells nothing on its way lives as long as it speaks; but not for ever.
  if (!look.position && now_ns - began_ns_ < kLongest_ns) {
    progress_ns_ = std::max(progress_ns_, lens_.device_->heard_ns());
  }
  const auto stall_ns = static_cast<std::int64_t>(lens_.settings_.stall_s * kSecond_ns);
  if (now_ns - progress_ns_ > (is_halted_ ? kHalt_ns : stall_ns)) fail_stalled(now_ns);
}

void Voyage::fail_stalled(std::int64_t now_ns) {
  const std::string what = fmt::format(
      "{} made no progress for {:.1f} s on its way to {}; is it blocked, or out of power? "
      "stall_s = SECONDS waits longer",
      lens_.device_->name(), static_cast<double>(now_ns - progress_ns_) / kSecond_ns,
      lens_.place(goal_));
  if (!is_halted_) lens_.device_->halt();
  throw Error(ErrorCode::device_lost, what);
}

void Voyage::halt_if_wished() {
  if (is_halted_ || (!wishes_stop_ && !trip_.watch.stopped())) return;
  // Where a device cannot be stopped its move is waited out, so that it stands all the same.
  if (lens_.device_->can_stop()) {
    lens_.device_->halt();
    progress_ns_ = monotonic_now_ns();
    unchanged_since_ns_ = progress_ns_;
  }
  is_halted_ = true;
}

void Voyage::heed(const Look& look) {
  const std::int64_t now_ns = monotonic_now_ns();
  if (look.position) track_.add(*look.position, look.asked_ns, look.heard_ns);
  if (!is_at_rest(look, now_ns)) {
    heed_progress(look, now_ns);
  } else {
    end_leg();
  }
}

void Voyage::advance() {
  if (is_over_) return;
  try {
    halt_if_wished();
    heed(lens_.device_->look());
  } catch (...) {
    fail();
  }
}

void Voyage::fail() noexcept {
  problem_ = std::current_exception();
  track_.lose();
  is_over_ = true;
}

void Voyage::end_leg() {
  if (is_halted_) return finish(true);
  if (++leg_ < trip_.legs.size()) return begin_leg();
  finish(false);
}

void Voyage::finish(bool was_halted) {
  const std::int64_t stopped_ns = monotonic_now_ns();
  const double stands = lens_.device_->position();
  const int step = lens_.step_at(stands);
  const double beside = std::abs(stands - lens_.place(trip_.to));
  if (!was_halted && beside > accuracy_of(lens_.info_)) {
    throw Error(ErrorCode::device_lost,
                fmt::format("{} stopped at {} on its way to {}; is it blocked, or does its travel "
                            "end there?",
                            lens_.device_->name(), stands, lens_.place(trip_.to)));
  }
  lens_.arrive({step, !was_halted || (trip_.from.is_approached && track_.is_taken_up())});
  if (was_halted) {
    track_.rest();
  } else {
    track_.arrive(lens_.place(step), stopped_ns);
  }
  is_over_ = true;
  lens_.rests_since_ns_ = stopped_ns;
  arrival_.position = lens_.place(step);
  arrival_.stopped_ns = stopped_ns;
  arrival_.settled_ns = stopped_ns + lens_.settings_.traits.settle_ns();
  if (!was_halted) return;
  arrival_.note =
      fmt::format("stopped on the way from {} to {}; the lens stands at {}",
                  lens_.place(trip_.from.position), lens_.place(trip_.to), arrival_.position);
  // Whoever did not wish for it through a Motion is the user, who is not asked twice.
  if (wishes_stop_ && !trip_.watch.stopped()) return;
  problem_ = std::make_exception_ptr(Error(ErrorCode::cancelled, arrival_.note));
}

std::optional<Arrival> Voyage::arrived() {
  advance();
  if (problem_) std::rethrow_exception(problem_);
  if (!is_over_) return std::nullopt;
  if (monotonic_now_ns() >= arrival_.settled_ns) return arrival_;
  if (trip_.watch.stopped()) {
    problem_ = std::make_exception_ptr(
        Error(ErrorCode::cancelled,
              fmt::format("stopped while the lens settled at {}", arrival_.position)));
    std::rethrow_exception(problem_);
  }
  return std::nullopt;
}

Arrival Voyage::wait() {
  for (;;) {
    if (const auto arrival = arrived()) return *arrival;
    sleep_until_ns(monotonic_now_ns() + kPause_ns);
  }
}

/// The device is asked once more, so that what is asked for lies between two answers.
Where Voyage::during(const Exposure& exposure) {
  advance();
  return track_.during(exposure, monotonic_now_ns());
}

}  // namespace fathom::serial
