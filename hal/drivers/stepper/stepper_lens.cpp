// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/stepper/stepper_lens.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "engine/error.hpp"
#include "hal/approach.hpp"

namespace fathom::stepper {
namespace {

Owner owner_of(const Settings& settings, const std::string& lines_name) {
  return {settings.identity(lines_name), settings.homing.end, settings.highest,
          settings.backlash_steps()};
}

std::filesystem::path state_path(const Settings& settings, const std::string& lines_name) {
  return settings.state.empty() ? default_state_path(lines_name)
                                : std::filesystem::path(settings.state);
}

/// What a homing tells about the counter, which was right only if the switch came where it said.
std::string lost_steps(int counted, int end) {
  if (counted == end) return {};
  const int off = std::abs(counted - end);
  return fmt::format("the home switch came {} step{} {}: steps were lost, or the lens was turned",
                     off, off == 1 ? "" : "s", counted > end ? "early" : "late");
}

}  // namespace

StepperLens::StepperLens(const Settings& settings, std::unique_ptr<Lines> lines, TimeSource& time,
                         StopRequests stop_requests)
    : settings_(settings),
      whereabouts_(state_path(settings_, lines->name()), owner_of(settings_, lines->name())),
      motor_(std::move(lines), time, settings_.pulse),
      time_(time),
      stop_requests_(std::move(stop_requests)) {}

LensInfo StepperLens::info() const {
  LensInfo info;
  info.description = fmt::format("stepper motor on {}", motor_.lines().name());
  info.unit = "steps";
  info.lowest = settings_.lowest;
  info.highest = settings_.highest;
  settings_.traits.describe(info);
  return info;
}

const Standing& StepperLens::known() const {
  if (whereabouts_.standing()) return *whereabouts_.standing();
  const bool can_home = settings_.homing.by != HomeBy::nobody;
  throw Error(ErrorCode::unavailable,
              fmt::format("where the lens stands is not known: {}; look at it and type: fathom "
                          "rigs home RIG --at POSITION{}",
                          whereabouts_.reason(),
                          can_home ? "; or let it find its end: fathom rigs home RIG" : ""));
}

double StepperLens::position() const { return known().position; }

/// The end, where the motor cannot go farther down, takes the place of the approach; the lowest
/// position that may be asked for does not, where there is room below it.
std::vector<int> StepperLens::legs(const Standing& from, int to) const {
  const int backlash = settings_.backlash_steps(), end = settings_.homing.end;
  if (from.is_approached) return approach_moves(from.position, to, backlash, end);
  const int turn = std::max(to - backlash, end);
  if (from.position <= turn) return approach_moves(from.position, to, backlash, end);
  std::vector<int> moves{turn - from.position};
  if (to > turn) moves.push_back(to - turn);
  return moves;
}

/// Moves and tells the file, whatever comes of it. Where the lines fail, the file says already that
/// nobody knows.
Standing StepperLens::travel(const Standing& from, int to, const StopWatch& watch) {
  const std::vector<int> moves = legs(from, to);
  Standing now = from;
  for (const int move : moves) {
    const Motor::Run run = motor_.run(move, settings_.pace, [&watch] { return watch.stopped(); });
    now.position += run.made;
    if (!run.was_ended) continue;
    now.is_approached = from.is_approached && moves.size() == 1 && move > 0;
    whereabouts_.arrive(now);
    throw Error(ErrorCode::cancelled,
                fmt::format("stopped on the way from {} to {}; the lens stands at {}",
                            from.position, to, now.position));
  }
  now.is_approached = true;
  return now;
}

/// Tells the file while the lens settles, and waits for that.
void StepperLens::finish(Arrival& arrival, const StopWatch& watch) {
  arrival.settled_ns = arrival.stopped_ns + settings_.traits.settle_ns();
  if (!sleep_unless(time_, arrival.settled_ns, [&watch] { return watch.stopped(); })) return;
  throw Error(ErrorCode::cancelled,
              fmt::format("stopped while the lens settled at {}", arrival.position));
}

Arrival StepperLens::move_to(double position) {
  require_within(info(), position);
  const StopWatch watch(stop_requests_);
  const Standing from = known();
  const int to = static_cast<int>(nearest(position));
  Arrival arrival;
  arrival.position = to;
  if (legs(from, to).empty()) {
    arrival.started_ns = arrival.stopped_ns = arrival.settled_ns = time_.now_ns();
    return arrival;
  }
  whereabouts_.leave(fmt::format("moving from {} to {}", from.position, to));
  arrival.started_ns = time_.now_ns();
  const Standing now = travel(from, to, watch);
  arrival.stopped_ns = time_.now_ns();
  whereabouts_.arrive(now);
  finish(arrival, watch);
  return arrival;
}

Arrival StepperLens::home() {
  if (settings_.homing.by == HomeBy::nobody) {
    throw Error(ErrorCode::unsupported,
                "this motor cannot look for its end: its rig file has home_by = \"none\"; look at "
                "the lens and type: fathom rigs home RIG --at POSITION, or set home_by to "
                "\"stop\" or \"switch\"");
  }
  const StopWatch watch(stop_requests_);
  const std::optional<Standing> before = whereabouts_.standing();
  const int end = settings_.homing.end;
  Arrival arrival;
  arrival.position = settings_.lowest;
  whereabouts_.leave("going home");
  arrival.started_ns = time_.now_ns();
  const int made = go_home(motor_, settings_.homing, [&watch] { return watch.stopped(); });
  if (before && settings_.homing.by == HomeBy::by_switch) {
    arrival.note = lost_steps(before->position + made, end);
  }
  const Standing now = travel({end, true}, settings_.lowest, watch);
  arrival.stopped_ns = time_.now_ns();
  whereabouts_.arrive(now);
  finish(arrival, watch);
  return arrival;
}

void StepperLens::declare_at(double position) {
  require_within(info(), position);
  const int at = static_cast<int>(nearest(position));
  // A power cut must not bring back what is on the disk now: it is wrong, or nobody would say so.
  whereabouts_.leave("being told where it stands");
  // Whichever way it was brought there, the play may be on the wrong side.
  whereabouts_.arrive({at, settings_.backlash_steps() == 0});
}

}  // namespace fathom::stepper
