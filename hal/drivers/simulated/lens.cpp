// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/lens.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/error.hpp"
#include "hal/approach.hpp"
#include "hal/drivers/simulated/thin_lens.hpp"

namespace fathom::simulated {

LensInfo SimulatedLens::info() const {
  const WorldSettings& rig = world_->settings();
  const Objective& objective = world_->objective();
  LensInfo info;
  info.description = fmt::format("simulated {} mm lens at f/{}, backlash {} {}, {} {}/s",
                                 objective.focal_mm, rig.f_number, rig.backlash_steps,
                                 objective.unit, rig.rate_steps_per_s, objective.unit);
  info.unit = objective.unit;
  info.lowest = 0;
  info.highest = objective.travel;
  info.resolution = 1;
  info.coarse_spacing = 0;
  if (!rig.tells_optics || !objective.tells_optics) return info;
  // A sample at most 56 steps from best focus at f/4 stands clearly above the floor; the disc of
  // confusion is the same at more steps for a smaller aperture.
  info.coarse_spacing = std::min(std::round(28 * rig.f_number), kTravelSteps / 4.0);
  info.optics = Optics{kFocalLengthMm, rig.f_number, kPitchMm};
  // Some four percent more at infinity, and less at the near end.
  info.blur_px_per_unit =
      disc_of_confusion_mm(kTravelSteps / 2.0 + 1, focused_distance_mm(kTravelSteps / 2.0),
                           rig.f_number) /
      kPitchMm;
  return info;
}

double SimulatedLens::position() const {
  if (motion_ != nullptr && !motion_->is_over()) {
    throw Error(ErrorCode::unavailable,
                "the lens is on its way; wait until it has arrived, or ask its motion");
  }
  return world_->motor().counter();
}

void SimulatedLens::require_its_own() const {
  if (motion_ == nullptr) return;
  throw Error(ErrorCode::unavailable,
              "the lens belongs to a motion that was started; end that first");
}

/// Below 0 the stop holds the lens while the motor still turns through the play, so even position 0
/// is approached upward and the lens stands where the counter says.
std::vector<int> SimulatedLens::legs(int to) const {
  const int from = world_->motor().counter(), play = world_->settings().backlash_steps;
  return approach_moves(is_approached_, from, to, play, -play);
}

Arrival SimulatedLens::move_to(double position) {
  require_its_own();
  require_within(info(), position);
  const std::int64_t started_ns = world_->now_ns();
  for (const int steps : legs(static_cast<int>(nearest(position)))) world_->step(steps);
  is_approached_ = true;
  return settled(started_ns);
}

Arrival SimulatedLens::home() {
  require_its_own();
  const std::int64_t started_ns = world_->now_ns();
  const int play = world_->settings().backlash_steps;
  // Too fast a motor does not make all its steps, wherever the lens is: push on until it must be
  // there.
  const Motor& motor = world_->motor();
  world_->step(-static_cast<int>(std::ceil(1.5 * (motor.travel() + play) / motor.followed())));
  world_->set_counter(-play);
  world_->step(play);
  is_approached_ = true;
  return settled(started_ns);
}

Arrival SimulatedLens::settled(std::int64_t started_ns) {
  const std::int64_t stopped_ns = world_->now_ns();
  world_->settle();
  return {.position = position(),
          .started_ns = started_ns,
          .stopped_ns = stopped_ns,
          .settled_ns = world_->now_ns()};
}

std::unique_ptr<Motion> SimulatedLens::start(double position) {
  require_its_own();
  require_within(info(), position);
  const int to = static_cast<int>(nearest(position));
  return std::make_unique<SimulatedMotion>(*this, legs(to), to);
}

SimulatedMotion::SimulatedMotion(SimulatedLens& lens, std::vector<int> legs, int to)
    : lens_(lens),
      world_(*lens.world_),
      watch_(lens.stop_requests_),
      from_(world_.motor().counter()),
      to_(to),
      started_ns_(world_.now_ns()) {
  const double play = world_.settings().backlash_steps;  // exactly so much
  log_ = std::make_shared<StepLog>(from_, lens.is_approached_, Play{play, play},
                                   world_.last_step_ns());
  world_.start(std::move(legs), [log = log_](int direction, std::int64_t time_ns) {
    log->make_step(direction, [time_ns] { return time_ns; });
  });
  lens_.motion_ = this;
}

SimulatedMotion::~SimulatedMotion() {
  world_.halt();
  lens_.is_approached_ = log_->is_taken_up();
  lens_.motion_ = nullptr;
}

std::int64_t SimulatedMotion::stopped_ns() const {
  return std::max(started_ns_, world_.last_step_ns());
}

bool SimulatedMotion::is_over() const {
  return was_cancelled_ || (!world_.is_moving() && world_.now_ns() >= settled_ns());
}

void SimulatedMotion::stop() {
  if (!world_.is_moving()) return;
  world_.halt();
  was_stopped_ = true;
}

/// A user's wish ends the way, and the settling too.
void SimulatedMotion::heed_wish() {
  if (is_over() || !watch_.stopped()) return;
  world_.halt();
  was_cancelled_ = true;
}

std::optional<Arrival> SimulatedMotion::arrived() {
  heed_wish();
  if (is_over()) return arrival();
  if (world_.now_ns() == asked_ns_) pass_time();
  asked_ns_ = world_.now_ns();
  return std::nullopt;
}

void SimulatedMotion::pass_time() {
  if (world_.is_moving()) {
    world_.pass_step();
  } else {
    world_.pass_until(settled_ns());
  }
}

Arrival SimulatedMotion::wait() {
  for (heed_wish(); !is_over(); heed_wish()) pass_time();
  return arrival();
}

Arrival SimulatedMotion::arrival() const {
  const int stands_at = world_.motor().counter();
  Arrival arrival;
  arrival.position = stands_at;
  arrival.started_ns = started_ns_;
  arrival.stopped_ns = stopped_ns();
  arrival.settled_ns = settled_ns();
  if (was_stopped_ || was_cancelled_) {
    arrival.note = fmt::format("stopped on the way from {} to {}; the lens stands at {}", from_,
                               to_, stands_at);
  }
  if (was_cancelled_) throw Error(ErrorCode::cancelled, arrival.note);
  return arrival;
}

Where SimulatedMotion::do_during(const Exposure& exposure) const {
  return log_->during(exposure, world_.now_ns());
}

}  // namespace fathom::simulated
