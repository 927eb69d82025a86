// SPDX-License-Identifier: Apache-2.0
#include "hal/step_log.hpp"

#include <algorithm>
#include <cmath>

namespace fathom {
namespace {

/// A rotor that turns is somewhere within a step of where its pulses say: variance of a uniform
/// distribution over one step either way.
constexpr double kVarianceOfTurning = 1.0 / 3;

}  // namespace

StepLog::StepLog(int position, bool is_approached, const Play& play, std::int64_t since_ns)
    : play_(play),
      position_(position),
      places_{{since_ns,
               {static_cast<double>(position), is_approached ? position : position + play.most}}} {}

void StepLog::add(int direction, std::int64_t time_ns) {
  position_ += direction;
  places_.push_back({time_ns, dragged(places_.back().glass, position_, play_)});
  first_step_ns_ = std::min(first_step_ns_, time_ns);
  last_step_ns_ = time_ns;
}

void StepLog::arrive(std::int64_t time_ns) {
  const std::lock_guard lock(mutex_);
  const double motor = position_;
  if (places_.back().glass.highest != motor) places_.push_back({time_ns, {motor, motor}});
}

bool StepLog::is_taken_up() const {
  const std::lock_guard lock(mutex_);
  return places_.back().glass.highest == position_;
}

KnownTime StepLog::known_time(std::int64_t now_ns) const {
  const auto lost_ns = is_lost_ ? std::optional(places_.back().since_ns) : std::nullopt;
  return {places_.front().since_ns, now_ns, lost_ns};
}

bool StepLog::turns_during(const Exposure& exposure) const {
  return exposure.end_ns >= first_step_ns_ && exposure.start_ns <= last_step_ns_;
}

Where StepLog::during(const Exposure& exposure, std::int64_t now_ns) const {
  const std::lock_guard lock(mutex_);
  require_known(exposure, known_time(now_ns));
  const auto later = std::upper_bound(
      places_.begin(), places_.end(), exposure.start_ns,
      [](std::int64_t time_ns, const Place& place) { return time_ns < place.since_ns; });
  auto place = std::prev(later);
  double lowest = place->glass.middle(), highest = lowest, sum = 0, width_sum = 0;
  std::int64_t from_ns = exposure.start_ns;
  const auto stay_until = [&](std::int64_t until_ns) {
    const auto stay_ns = static_cast<double>(until_ns - from_ns);
    sum += stay_ns * place->glass.middle();
    width_sum += stay_ns * place->glass.width();
    lowest = std::min(lowest, place->glass.middle());
    highest = std::max(highest, place->glass.middle());
    from_ns = until_ns;
  };
  for (auto next = later; next != places_.end() && next->since_ns < exposure.end_ns; ++next) {
    stay_until(next->since_ns);
    place = next;
  }
  const auto length_ns = static_cast<double>(exposure.end_ns - exposure.start_ns);
  stay_until(exposure.end_ns);
  const double width = length_ns > 0 ? width_sum / length_ns : place->glass.width();
  const double turning = turns_during(exposure) ? kVarianceOfTurning : 0;
  return {.position = length_ns > 0 ? sum / length_ns : place->glass.middle(),
          .sigma = std::sqrt(variance_within(width) + turning),
          .smear = highest - lowest};
}

}  // namespace fathom
