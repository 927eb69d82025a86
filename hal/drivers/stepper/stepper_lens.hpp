// SPDX-License-Identifier: Apache-2.0
// A lens that a stepper motor turns, without anybody who looks.
#pragma once

#include <memory>
#include <vector>

#include "hal/drivers/stepper/motor.hpp"
#include "hal/drivers/stepper/settings.hpp"
#include "hal/drivers/stepper/stepper_motion.hpp"
#include "hal/lens.hpp"
#include "hal/step_log.hpp"
#include "hal/stop.hpp"
#include "hal/whereabouts.hpp"

namespace fathom::stepper {

class StepperLens final : public Lens {
 public:
  /// `time` must outlive this. Throws as Whereabouts does.
  StepperLens(const Settings& settings, std::unique_ptr<Lines> lines, TimeSource& time,
              StopRequests stop_requests);

  LensInfo info() const override;
  double position() const override;
  Arrival move_to(double position) override;
  std::unique_ptr<Motion> start(double position) override;
  std::string why_unwatched() const override { return {}; }
  Arrival home() override;
  void declare_at(double position) override;

 private:
  /// A move that nothing speaks against, not begun.
  struct Trip {
    Standing from;
    int to;
    std::vector<int> legs;  ///< Empty where it stands there already.
    StopWatch watch;
  };

  void require_its_own() const;
  const Standing& known() const;
  std::vector<int> legs(const Standing& from, int to) const;
  Trip plan(double position) const;
  std::shared_ptr<StepLog> log_from(const Standing& from) const;
  void leave(const Trip& trip);
  Arrival stay(const Trip& trip) const;
  Arrival go(const Trip& trip, StepLog& log, const Wishes& wishes);
  bool travel(const Trip& trip, Standing& now, StepLog& log, const Wishes& wishes);
  void settle(Arrival& arrival, const StopWatch& watch, const Wishes& wishes);

  Settings settings_;
  Whereabouts whereabouts_;  // its lock is given back last, once the wires are at rest
  Motor motor_;
  TimeSource& time_;
  StopRequests stop_requests_;
  StepperMotion* motion_ = nullptr;  // the one that lives
};

}  // namespace fathom::stepper
