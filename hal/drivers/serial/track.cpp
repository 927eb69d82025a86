// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/serial/track.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::serial {
namespace {

double real(std::int64_t ns) { return static_cast<double>(ns); }

}  // namespace

Track::Track(double position, bool is_approached, double play, double resolution,
             std::int64_t since_ns)
    : play_{.most = play}, resolution_(resolution) {
  places_.push_back({since_ns, 0, {position, position + (is_approached ? 0 : play)}});
}

void Track::depart(std::int64_t now_ns) {
  Place place = places_.back();
  place.time_ns = std::max(now_ns, place.time_ns);
  places_.push_back(place);
  departed_ = places_.size() - 1;
}

void Track::add(double position, std::int64_t asked_ns, std::int64_t heard_ns) {
  const Place& before = places_.back();
  const std::int64_t time_ns = std::max(asked_ns + (heard_ns - asked_ns) / 2, before.time_ns);
  places_.push_back(
      {time_ns, real(heard_ns - asked_ns) / 2, dragged(before.glass, position, play_)});
}

void Track::arrive(double position, std::int64_t time_ns) {
  places_.push_back({std::max(time_ns, places_.back().time_ns), 0, {position, position}});
  rests_ = true;
}

KnownTime Track::known_time(std::int64_t now_ns) const {
  const auto lost_ns = is_lost_ ? std::optional(places_.back().time_ns) : std::nullopt;
  return {places_.front().time_ns, now_ns, lost_ns};
}

double Track::speed(std::size_t i) const {
  if (i + 1 >= places_.size()) return 0;
  const std::int64_t apart_ns = places_[i + 1].time_ns - places_[i].time_ns;
  return apart_ns == 0
             ? 0
             : (places_[i + 1].glass.middle() - places_[i].glass.middle()) / real(apart_ns);
}

/// How far the line may be off where the speed changes, at the end of the i-th interval: it changed
/// somewhere in the shorter one of the two.
double Track::bend(std::size_t i) const {
  if (i + 1 >= places_.size()) return 0;
  const bool is_last = i + 2 >= places_.size();
  const std::int64_t here_ns = places_[i + 1].time_ns - places_[i].time_ns;
  const std::int64_t next_ns = is_last ? here_ns : places_[i + 2].time_ns - places_[i + 1].time_ns;
  return std::abs(speed(i + 1) - speed(i)) * real(std::min(here_ns, next_ns)) / 4;
}

/// Of a place between the i-th and the next: when the answers were true, how the speed changes, the
/// play, and the smallest number that the device tells.
double Track::variance(std::size_t i) const {
  const bool is_last = i + 1 >= places_.size();
  const Place& from = places_[i];
  const Place& to = is_last ? from : places_[i + 1];
  const double here = speed(i);
  const double timing = std::abs(here) * std::max(from.half_ns, to.half_ns) / std::sqrt(3);
  const double bending = std::max(i == 0 ? 0 : bend(i - 1), bend(i)) / std::sqrt(3);
  const double lag = variance_within(std::max(from.glass.width(), to.glass.width()));
  if (i < departed_) return lag;
  const double digit = is_last && rests_ ? 0 : variance_within(resolution_);
  return timing * timing + bending * bending + lag + digit;
}

double Track::at(std::int64_t time_ns) const {
  const auto after =
      std::upper_bound(places_.begin(), places_.end(), time_ns,
                       [](std::int64_t time, const Place& place) { return time < place.time_ns; });
  if (after == places_.end()) return places_.back().glass.middle();
  const auto i = static_cast<std::size_t>(after - places_.begin()) - 1;
  return places_[i].glass.middle() + speed(i) * real(time_ns - places_[i].time_ns);
}

Where Track::during(const Exposure& exposure, std::int64_t now_ns) const {
  require_known(exposure, known_time(now_ns));
  const double first = at(exposure.start_ns), last = at(exposure.end_ns);
  double lowest = std::min(first, last), highest = std::max(first, last);
  double area = 0, variance_there = 0;
  std::int64_t time_ns = exposure.start_ns;
  double place = first;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const bool is_last = i + 1 == places_.size();
    const std::int64_t end_ns = is_last ? exposure.end_ns : places_[i + 1].time_ns;
    if (end_ns < exposure.start_ns || places_[i].time_ns > exposure.end_ns) continue;
    variance_there = std::max(variance_there, variance(i));
    const std::int64_t until_ns = std::clamp(end_ns, time_ns, exposure.end_ns);
    const double next = at(until_ns);
    area += (place + next) / 2 * real(until_ns - time_ns);
    lowest = std::min(lowest, next);
    highest = std::max(highest, next);
    time_ns = until_ns;
    place = next;
  }
  const double length = real(exposure.end_ns - exposure.start_ns);
  return {.position = length > 0 ? area / length : first,
          .sigma = std::sqrt(variance_there),
          .smear = highest - lowest};
}

}  // namespace fathom::serial
