// SPDX-License-Identifier: Apache-2.0
// A stepper motor behind its driver board: pulses, in time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "hal/drivers/stepper/lines.hpp"
#include "hal/drivers/stepper/pace.hpp"
#include "hal/drivers/stepper/time_source.hpp"
#include "hal/step_log.hpp"

namespace fathom::stepper {

/// What the driver board wants of a pulse.
struct Pulse {
  StepRest rest = false;      ///< See there.
  bool up_level = true;       ///< The level of DIR at which positions grow.
  std::int64_t width_ns = 0;  ///< STEP stays that long at either level, at least.
  std::int64_t setup_ns = 0;  ///< From a change of DIR to the next step, at least.
  std::int64_t hold_ns = 0;   ///< From a step to the next change of DIR, at least.
};

class Motor {
 public:
  /// `time` must outlive this.
  Motor(std::unique_ptr<Lines> lines, TimeSource& time, const Pulse& pulse);

  struct Run {
    int made = 0;            ///< Steps made, downward negative.
    bool was_ended = false;  ///< Whether `enough` ended it.
  };

  /// Makes steps, downward if negative, never two of them closer than the pace allows, also across
  /// runs, and also where this process was held up: a late step delays those after it, and after
  /// a wait that was long enough to stop the motor, the ramp begins anew. `enough` is asked before
  /// every step; once it says so, the motor comes to rest, down the ramp if there is one. Throws
  /// what the lines throw: how many steps were made is then not known. `log`, if there is one, gets
  /// every step with the middle of the write that made it.
  Run run(int steps, const Pace& pace, const std::function<bool()>& enough, StepLog* log = nullptr);

  Lines& lines() const { return *lines_; }
  /// When the last step began; 0 before the first.
  std::int64_t last_step_ns() const { return last_step_ns_; }

 private:
  void turn(bool up);
  void step(int direction, StepLog* log);
  /// The edge that is a step; returns when it was.
  std::int64_t write_edge();
  /// After lines that failed in the middle of a pulse, and then obey again: the next pulse must
  /// have its edge.
  void end_broken_pulse();

  std::unique_ptr<Lines> lines_;
  TimeSource& time_;
  Pulse pulse_;
  bool step_level_;
  bool is_at_rest_ = true;
  int direction_ = 0;               // 0 before the first
  std::int64_t step_begun_ns_ = 0;  // before the last step's write,
  std::int64_t last_step_ns_ = 0;   // and after it
  std::int64_t next_step_ns_ = 0;   // not before
};

}  // namespace fathom::stepper
