// SPDX-License-Identifier: Apache-2.0
#include "session/run.hpp"

#include <cmath>
#include <numeric>

namespace fathom {

std::vector<Evaluation> Run::evaluations() const {
  std::vector<Evaluation> evaluations;
  for (const Measurement& m : measurements) {
    const Sample sample = m.sample();
    const int loop = static_cast<int>(evaluations.size()) + 1;
    evaluations.push_back({loop, m.position, sample.score, sample.picture, sample.on_the_way});
  }
  return evaluations;
}

std::vector<Evaluation> Run::evaluations_at_rest() const {
  std::vector<Evaluation> at_rest = evaluations();
  std::erase_if(at_rest, [](const Evaluation& e) { return e.on_the_way.has_value(); });
  return at_rest;
}

TimeSpent time_spent(std::span<const Measurement> measurements) {
  TimeSpent spent;
  for (const Measurement& m : measurements) {
    spent.moving += 1e-9 * static_cast<double>(m.stopped_ns - m.started_ns);
    spent.settling += 1e-9 * static_cast<double>(m.settled_ns - m.stopped_ns);
    spent.exposing += 1e-9 * static_cast<double>(m.exposure.end_ns - m.settled_ns);
    spent.computing += 1e-9 * static_cast<double>(m.compute_ns);
  }
  return spent;
}

std::vector<Sighting> Run::sightings() const {
  std::vector<Sighting> sightings;
  for (const Measurement& m : measurements) {
    if (!m.on_the_way) sightings.push_back({m.position, m.sample().score, middle_s(m)});
  }
  return sightings;
}

Journey journey_of(const Run& run) {
  Journey journey;
  journey.frames = run.repeats;
  if (run.measurements.empty()) return journey;
  for (const Measurement& m : run.measurements) {
    journey.frames += m.frames;
    if (m.on_the_way) journey.on_the_way += m.frames;
  }
  // The way back begins when the search is over.
  std::span<const Measurement> way = run.measurements;
  const bool is_back = run.limits && run.limits->returns && way.size() > 1 &&
                       way.back().position == way.front().position;
  if (is_back) way = way.first(way.size() - 1);
  double here = run.start_position.value_or(way.front().position);
  for (const Measurement& m : way) {
    const double from = m.set_out_from.value_or(here);
    journey.travel += std::abs(from - here) + std::abs(m.position - from);
    here = m.position;
  }
  const std::int64_t started_ns = run.started_ns.value_or(way.front().started_ns);
  journey.rig_seconds = 1e-9 * static_cast<double>(way.back().exposure.end_ns - started_ns);
  return journey;
}

Journey journey_of(std::span<const Run> runs) {
  Journey all;
  for (const Run& run : runs) {
    const Journey one = journey_of(run);
    all.travel += one.travel;
    all.rig_seconds += one.rig_seconds;
    all.frames += one.frames;
    all.on_the_way += one.on_the_way;
  }
  return all;
}

double middle_s(const Measurement& measurement) {
  const Exposure& exposure = measurement.exposure;
  return 1e-9 * static_cast<double>(std::midpoint(exposure.start_ns, exposure.end_ns));
}

}  // namespace fathom
