// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/http/lens.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/error.hpp"
#include "hal/clock.hpp"

namespace fathom::http {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLookRound{500};

}  // namespace

LensInfo HttpLens::info() const {
  LensInfo info = link_->facts().lens;
  info.description += fmt::format(" at {}", link_->where());
  return info;
}

double HttpLens::position() const {
  return number_from(link_->get("rig/position").body, "position");
}

std::string HttpLens::why_unwatched() const {
  return "a service tells where its lens is only at rest";
}

void HttpLens::declare_at(double) {
  throw Error(
      ErrorCode::unsupported,
      fmt::format("{}: where it stands is declared where it is plugged in (fathom rigs home "
                  "RIG --at POSITION)",
                  info().description));
}

Arrival HttpLens::move_to(double position) {
  require_within(link_->facts().lens, position);
  return go(fmt::format("{{\"position\":{:.17g}}}", position));
}

Arrival HttpLens::home() { return go("{\"home\":true}"); }

/// Camera stamps are early, arrivals are late.
Arrival HttpLens::go(const std::string& body) {
  const std::string answer = link_->post("rig/move", body).body;
  const Moved moved = follow(whole_from(answer, "id"));
  if (moved.failure) throw *moved.failure;
  link_->note_recorded_here(moved.recorded_here);
  const ClockMap& clock = link_->clock();
  Arrival arrival = moved.arrival;
  arrival.started_ns = clock.earliest(arrival.started_ns);
  arrival.stopped_ns = clock.latest(arrival.stopped_ns);
  arrival.settled_ns = clock.latest(arrival.settled_ns);
  return arrival;
}

Moved HttpLens::look(int id, milliseconds wait, bool may_stop) {
  const std::string path = fmt::format("rig/moved?id={}&wait_ms={}", id, wait.count());
  return moved_from(
      (may_stop ? link_->get(path, 1 << 16, wait) : link_->get_unstopped(path, wait)).body);
}

/// To its end, also where it is stopped: a motor that nobody watches must not go on.
Moved HttpLens::follow(int id) {
  try {
    while (true) {
      const Moved moved = look(id, kLookRound, true);
      if (moved.is_done) return moved;
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::cancelled) throw;
    return stop(id);
  }
}

Moved HttpLens::stop(int id) {
  constexpr std::int64_t kLongest_ns = 20'000'000'000;
  const std::int64_t deadline_ns = monotonic_now_ns() + kLongest_ns;
  link_->post_unstopped("stop", "{}");
  while (monotonic_now_ns() < deadline_ns) {
    Moved moved = look(id, kLookRound, false);
    if (!moved.is_done) continue;
    if (!moved.failure) moved.failure.emplace(ErrorCode::cancelled, "stopped on request");
    return moved;
  }
  throw Error(ErrorCode::timeout,
              fmt::format("{} was told to stop and has not stopped", info().description));
}

double HttpStage::distance_mm() const {
  return number_from(link_->get("rig/stage").body, "distance");
}

double HttpStage::distance_mm(double x_px, double y_px) const {
  return number_from(link_->get(fmt::format("rig/stage?x={:.17g}&y={:.17g}", x_px, y_px)).body,
                     "distance");
}

void HttpStage::place_at(double distance_mm) {
  if (!std::isfinite(distance_mm))
    throw Error(ErrorCode::out_of_bounds, "a distance is a number of mm");
  link_->post("rig/place", fmt::format("{{\"distance\":{:.17g}}}", distance_mm));
}

}  // namespace fathom::http
