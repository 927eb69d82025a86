// SPDX-License-Identifier: Apache-2.0
// A lens that a stepper motor turns, without anybody who looks.
#pragma once

#include <memory>
#include <vector>

#include "hal/drivers/stepper/motor.hpp"
#include "hal/drivers/stepper/settings.hpp"
#include "hal/drivers/stepper/whereabouts.hpp"
#include "hal/lens.hpp"
#include "hal/stop.hpp"

namespace fathom::stepper {

class StepperLens final : public Lens {
 public:
  /// `time` must outlive this. Throws as Whereabouts does.
  StepperLens(const Settings& settings, std::unique_ptr<Lines> lines, TimeSource& time,
              StopRequests stop_requests);

  LensInfo info() const override;
  double position() const override;
  Arrival move_to(double position) override;
  Arrival home() override;
  void declare_at(double position) override;

 private:
  const Standing& known() const;
  std::vector<int> legs(const Standing& from, int to) const;
  Standing travel(const Standing& from, int to, const StopWatch& watch);
  void finish(Arrival& arrival, const StopWatch& watch);

  Settings settings_;
  Whereabouts whereabouts_;  // its lock is given back last, once the wires are at rest
  Motor motor_;
  TimeSource& time_;
  StopRequests stop_requests_;
};

}  // namespace fathom::stepper
