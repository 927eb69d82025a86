// SPDX-License-Identifier: Apache-2.0
// A rig as a search sees it: positions in, scores out. Every measurement goes into the run.
#pragma once

#include <optional>

#include "../focus/search.hpp"
#include "observer.hpp"
#include "rig.hpp"
#include "run.hpp"
#include "warning.hpp"

namespace fathom {

/// Tells an observer of frames.
FrameSeen told_to(Observer& observer);

class RigObjective {
 public:
  /// All of them must outlive this. The run's limits say how the lens blurs, where it is to travel.
  RigObjective(Rig& rig, Run& run, Observer& observer)
      : rig_(rig), run_(run), observer_(observer) {}

  /// At this position of the lens, at rest. Throws as Rig::measure.
  Sample score(double position);

  /// On the way there, as Objective::travel. Throws as Rig::measure_passing.
  void travel(double to, double apart, const PictureOnTheWay& goes_on);

  /// This, for a search; without its travel where the limits do not ask for that.
  Objective objective();

  /// Why pictures on the way were of no use, if they were not.
  const std::optional<HaltsInstead::Why>& why_halted() const { return why_halted_; }

 private:
  Sample take(Measurement made);
  void heed(const Measurement& made, double since_before);

  Rig& rig_;
  Run& run_;
  Observer& observer_;
  std::optional<Arrival> halted_;  // on its way, and nothing was measured since
  std::optional<HaltsInstead::Why> why_halted_;
};

}  // namespace fathom
