// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/stepper/stepper_lens.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <system_error>
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

double StepperLens::position() const {
  if (motion_ != nullptr && !motion_->is_over()) {
    throw Error(ErrorCode::unavailable,
                "the lens is on its way; wait until it has arrived, or ask its motion");
  }
  return known().position;
}

void StepperLens::require_its_own() const {
  if (motion_ == nullptr) return;
  throw Error(ErrorCode::unavailable,
              "the lens belongs to a motion that was started; end that first");
}

/// The end, where the motor cannot go farther down, takes the place of the approach; the lowest
/// position that may be asked for does not, where there is room below it.
std::vector<int> StepperLens::legs(const Standing& from, int to) const {
  const int backlash = settings_.backlash_steps(), end = settings_.homing.end;
  return approach_moves(from.is_approached, from.position, to, backlash, end);
}

StepperLens::Trip StepperLens::plan(double position) const {
  require_its_own();
  require_within(info(), position);
  const StopWatch watch(stop_requests_);
  const Standing from = known();
  const int to = static_cast<int>(nearest(position));
  return {from, to, legs(from, to), watch};
}

/// `backlash` is chosen to be enough: the gears may have less play than that.
std::shared_ptr<StepLog> StepperLens::log_from(const Standing& from) const {
  const Play play{0, static_cast<double>(settings_.backlash_steps())};
  return std::make_shared<StepLog>(from.position, from.is_approached, play, motor_.last_step_ns());
}

void StepperLens::leave(const Trip& trip) {
  whereabouts_.leave(fmt::format("moving from {} to {}", trip.from.position, trip.to));
}

/// Makes the steps, and says in `now` where the motor stands. Returns whether a wish ended it.
bool StepperLens::travel(const Trip& trip, Standing& now, StepLog& log, const Wishes& wishes) {
  const auto enough = [&] { return wishes.stop || trip.watch.stopped(); };
  now = trip.from;
  for (const int leg : trip.legs) {
    const Motor::Run run = motor_.run(leg, settings_.pace, enough, &log);
    now.position += run.made;
    if (!run.was_ended) continue;
    now.is_approached = log.is_taken_up();
    return true;
  }
  now.is_approached = true;
  log.arrive(time_.now_ns());
  return false;
}

/// Waits while the lens settles.
void StepperLens::settle(Arrival& arrival, const StopWatch& watch, const Wishes& wishes) {
  arrival.settled_ns = arrival.stopped_ns + settings_.traits.settle_ns();
  const auto enough = [&] { return wishes.hurry || watch.stopped(); };
  if (!sleep_unless(time_, arrival.settled_ns, enough)) return;
  throw Error(ErrorCode::cancelled,
              fmt::format("stopped while the lens settled at {}", arrival.position));
}

/// Moves and tells the file, whatever comes of it. Where the lines fail, the file says already that
/// nobody knows.
Arrival StepperLens::go(const Trip& trip, StepLog& log, const Wishes& wishes) {
  Arrival arrival;
  Standing now;
  arrival.started_ns = time_.now_ns();
  const bool was_ended = travel(trip, now, log, wishes);
  arrival.stopped_ns = time_.now_ns();
  arrival.position = now.position;
  whereabouts_.arrive(now);
  if (was_ended) {
    arrival.note = fmt::format("stopped on the way from {} to {}; the lens stands at {}",
                               trip.from.position, trip.to, now.position);
    // Whoever did not wish for it through a Motion is the user, who is not asked twice.
    if (!wishes.stop || trip.watch.stopped()) throw Error(ErrorCode::cancelled, arrival.note);
  }
  settle(arrival, trip.watch, wishes);
  return arrival;
}

Arrival StepperLens::stay(const Trip& trip) const {
  const std::int64_t now_ns = time_.now_ns();
  return {.position = static_cast<double>(trip.to),
          .started_ns = now_ns,
          .stopped_ns = now_ns,
          .settled_ns = now_ns};
}

Arrival StepperLens::move_to(double position) {
  const Trip trip = plan(position);
  if (trip.legs.empty()) return stay(trip);
  leave(trip);
  return go(trip, *log_from(trip.from), {});
}

std::unique_ptr<Motion> StepperLens::start(double position) {
  const Trip trip = plan(position);
  const auto log = log_from(trip.from);
  const bool stays = trip.legs.empty();
  if (!stays) leave(trip);
  const auto work = [this, trip, log, stays](const Wishes& wishes) {
    return stays ? stay(trip) : go(trip, *log, wishes);
  };
  try {
    return std::make_unique<StepperMotion>(work, log, time_, motion_);
  } catch (const std::system_error& problem) {
    if (!stays) whereabouts_.arrive(trip.from);  // not a step was made
    throw Error(ErrorCode::unavailable,
                fmt::format("no thread for the lens to move in: {}", problem.what()));
  }
}

Arrival StepperLens::home() {
  if (settings_.homing.by == HomeBy::nobody) {
    throw Error(ErrorCode::unsupported,
                "this motor cannot look for its end: its rig file has home_by = \"none\"; look at "
                "the lens and type: fathom rigs home RIG --at POSITION, or set home_by to "
                "\"stop\" or \"switch\"");
  }
  require_its_own();
  const StopWatch watch(stop_requests_);
  const std::optional<Standing> before = whereabouts_.standing();
  const int end = settings_.homing.end;
  whereabouts_.leave("going home");
  const std::int64_t started_ns = time_.now_ns();
  const int made = go_home(motor_, settings_.homing, [&watch] { return watch.stopped(); });
  const Standing at_end{end, true};
  const Trip trip{at_end, settings_.lowest, legs(at_end, settings_.lowest), watch};
  Arrival arrival = go(trip, *log_from(at_end), {});
  arrival.started_ns = started_ns;
  if (before && settings_.homing.by == HomeBy::by_switch) {
    arrival.note = lost_steps(before->position + made, end);
  }
  return arrival;
}

void StepperLens::declare_at(double position) {
  require_its_own();
  require_within(info(), position);
  const int at = static_cast<int>(nearest(position));
  // A power cut must not bring back what is on the disk now: it is wrong, or nobody would say so.
  whereabouts_.leave("being told where it stands");
  // Whichever way it was brought there, the play may be on the wrong side.
  whereabouts_.arrive({at, settings_.backlash_steps() == 0});
}

}  // namespace fathom::stepper
