// SPDX-License-Identifier: Apache-2.0
#include "session/rig_objective.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "focus/spectral_travel.hpp"

namespace fathom {

FrameSeen told_to(Observer& observer) {
  return [&observer](const Frame& frame, const Arrival& arrival, double score) {
    observer.frame(frame, arrival, {&score, 1});
  };
}

/// The way to a picture begins where the one before it was taken, or where the lens was halted since.
Sample RigObjective::take(Measurement made) {
  if (halted_) {
    made.set_out_from = halted_->position;
    made.started_ns = run_.measurements.back().exposure.end_ns;
    halted_.reset();
  }
  const Measurement& kept = run_.measurements.emplace_back(std::move(made));
  observer_.evaluated(kept);
  if (!kept.note.empty()) observer_.warned(LensNote{kept.position, kept.note});
  return kept.sample();
}

Sample RigObjective::score(double position) {
  return take(rig_.measure(position, told_to(observer_)));
}

void RigObjective::heed(const Measurement& made, double since_before) {
  if (!is_worth_it(*made.on_the_way, since_before, *run_.limits->blur))
    why_halted_ = HaltsInstead::Why::too_quick;
}

void RigObjective::travel(double to, double apart, const PictureOnTheWay& goes_on) {
  constexpr int kMostUnplaced = 10;
  const double boundless = std::numeric_limits<double>::infinity();
  double before = rig_.lens().position();
  const auto passed = [&](Measurement made) {
    const double since_before = std::abs(made.position - std::exchange(before, made.position));
    heed(made, since_before);
    const double position = made.position;
    return goes_on(position, take(std::move(made)));
  };
  bool is_refused = false;
  const auto told = [&](Measurement made) {
    is_refused = !passed(std::move(made));
    return !is_refused;
  };
  const std::int64_t since_ns =
      halted_ ? halted_->settled_ns : run_.measurements.back().exposure.end_ns;
  const Passage passage = rig_.measure_passing(to, since_ns,
                                               {.apart = apart,
                                                .most_smear = boundless,
                                                .most_sigma = boundless,
                                                .ends_at_rest = false,
                                                .seen_at = before,
                                                .most_unplaced = kMostUnplaced},
                                               told, told_to(observer_));
  if (!passage.is_cut) return;
  halted_ = passage.arrival;
  if (is_refused) return;
  why_halted_ = HaltsInstead::Why::unplaced;
  const double here = passage.arrival.position;
  if (here != to) goes_on(rig_.lens().nearest(here), score(here));
}

Objective RigObjective::objective() {
  Objective objective{[this](double position) { return score(position); },
                      [this](double position) { return rig_.lens().nearest(position); }};
  if (run_.limits && run_.limits->moves) {
    objective.travel = [this](double to, double apart, const PictureOnTheWay& goes_on) {
      travel(to, apart, goes_on);
    };
  }
  return objective;
}

}  // namespace fathom
